#include "editor/picking.h"

#include <cmath>

#include "base/box.h"
#include "editor/draw/set_surface.h"
#include "editor/pointer.h"

namespace neuvv::editor {

namespace {

constexpr float kPickedAlpha = 0.5f;

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

}  // namespace

PickedPoint pick_at(OnDevice& on_device, const stage::EvaluatedStage& evaluated, const stage::Camera& camera,
                    glm::dvec2 pixel) {
    const Ray ray = ray_through(camera, pixel);
    Nearest nearest;
    on_device.renderer.show(evaluated, true, render::MissingSegments::kHold);
    pick_performers(on_device, evaluated, camera, pixel, nearest);
    if (!nearest.node) {
        SetSurface set;
        set.follow(on_device.stage.scene, evaluated.pose);
        if (const auto hit = set.meet(ray)) nearest.take(hit->distance_m, hit->node);
    }
    if (!nearest.node) return {};
    return {nearest.node, ray.origin + nearest.metres * ray.direction};
}

}  // namespace neuvv::editor
