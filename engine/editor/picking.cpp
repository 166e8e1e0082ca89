#include "editor/picking.h"

#include <cmath>

#include "base/box.h"
#include "editor/pointer.h"

namespace neuvv::editor {

namespace {

constexpr float kPickedAlpha = 0.5f;

// Möller and Trumbore 1997; both sides of the triangle count. Infinite where the ray misses it.
double distance_to_triangle(const Ray& ray, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const glm::dvec3 ab = b - a, ac = c - a, across = glm::cross(ray.direction, ac);
    const double volume = glm::dot(ab, across);
    if (volume == 0) return INFINITY;
    const glm::dvec3 from_a = ray.origin - a, turned = glm::cross(from_a, ab);
    const double u = glm::dot(from_a, across) / volume, v = glm::dot(ray.direction, turned) / volume;
    const double t = glm::dot(ac, turned) / volume;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : INFINITY;
}

// The camera of an image of one pixel, which is this pixel of the given camera.
stage::Camera pixel_of_camera(stage::Camera camera, glm::dvec2 pixel) {
    camera.cx -= std::floor(pixel.x);
    camera.cy -= std::floor(pixel.y);
    camera.width = camera.height = 1;
    return camera;
}

struct Nearest {
    double metres = INFINITY;
    std::optional<uint32_t> node;
    void take(double at, uint32_t of) {
        if (!(at < metres)) return;
        metres = at;
        node = of;
    }
};

void pick_performers(OnDevice& on_device, const stage::EvaluatedStage& evaluated, const stage::Camera& camera,
                     glm::dvec2 pixel, Nearest& nearest) {
    const Ray ray = ray_through(camera, pixel);
    const stage::Camera one_pixel = pixel_of_camera(camera, pixel);
    render::FrameSettings settings = on_device.renderer.settings_at(evaluated);
    settings.width = settings.height = settings.samples = 1;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        const std::optional<render::Instance> instance = on_device.renderer.instance_of(performer);
        if (!instance) continue;
        const stage::StageClip& clip = on_device.stage.clips[performer.clip];
        if (!box_hit(ray, performer.world_from_performer, clip.box_min, clip.box_min + clip.box_size)) continue;
        settings.instances = {*instance};
        on_device.renderer.frames().draw({&one_pixel, 1}, settings);
        if (on_device.renderer.frames().radiance()[0].a < kPickedAlpha * performer.opacity) continue;
        nearest.take(on_device.renderer.frames().depth()[0], on_device.stage.performers[performer.performer].node);
    }
}

void pick_set(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, const Ray& ray, Nearest& nearest) {
    stage::PosedVertices vertices;
    for (uint32_t node = 0; node < stage.scene.nodes.size(); node++) {
        const stage::GltfNode& one = stage.scene.nodes[node];
        if (!one.draws_mesh()) continue;
        for (const stage::GltfPrimitive& primitive : stage.scene.meshes[static_cast<size_t>(one.mesh)].primitives) {
            stage::pose_vertices(stage.scene, evaluated.pose, node, primitive, vertices);
            for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
                nearest.take(distance_to_triangle(ray, vertices.positions[primitive.indices[i]],
                                                  vertices.positions[primitive.indices[i + 1]],
                                                  vertices.positions[primitive.indices[i + 2]]),
                             node);
        }
    }
}

}  // namespace

PickedPoint pick_at(OnDevice& on_device, const stage::EvaluatedStage& evaluated, const stage::Camera& camera,
                    glm::dvec2 pixel) {
    const Ray ray = ray_through(camera, pixel);
    Nearest nearest;
    on_device.renderer.show(evaluated, true, render::MissingSegments::kHold);
    pick_performers(on_device, evaluated, camera, pixel, nearest);
    if (!nearest.node) pick_set(on_device.stage, evaluated, ray, nearest);
    if (!nearest.node) return {};
    return {nearest.node, ray.origin + nearest.metres * ray.direction};
}

}  // namespace neuvv::editor
