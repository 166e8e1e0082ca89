#include "render/set/set_raster.h"

#include <cassert>
#include <optional>

#include "render/set/raster.h"

namespace neuvv::render {

SetRaster::SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height,
                     uint32_t views, const media::Image* environment)
    : SetRaster(device, scene, width, height, views, std::make_shared<SetEnvironment>(device, environment)) {}

SetRaster::SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height,
                     uint32_t views, std::shared_ptr<const SetEnvironment> environment)
    : lighting(device, std::move(environment)),
      device_(device),
      targets_(device, width, height, views),
      meshes_(device, scene, {*lighting.environment(), lighting, targets_.volume_depth}),
      background_(device, *lighting.environment(), lighting) {
    lighting.change_set(meshes_.box());
}

void SetRaster::change(const stage::GltfScene& scene, std::shared_ptr<const SetEnvironment> environment) {
    const bool same_environment = environment == lighting.environment(), had_transparent = has_transparent();
    std::optional<gpu::TextureSet> background;
    if (!same_environment) background = bind_background(background_.pass, *environment, lighting);
    const bool looks_different = meshes_.change(scene, surroundings(*environment), same_environment);
    // Nothing may fail from here on.
    if (background) background_.bound = std::move(*background);
    lighting.surround(std::move(environment));
    if (looks_different) lighting.change_set(meshes_.box());
    clear_front(had_transparent);
}

void SetRaster::resize(uint32_t width, uint32_t height) {
    targets_.resize(device_, width, height);
    meshes_.bind(surroundings(*lighting.environment()));
}

bool SetRaster::has_pose(const stage::PosedScene& pose) const {
    return meshes_.has_pose(pose);
}

void SetRaster::pose(const stage::PosedScene& pose) {
    if (meshes_.pose(pose)) lighting.change_set(meshes_.box());
}

void SetRaster::hide(std::span<const std::vector<glm::vec2>> corners) {
    assert((corners.empty() || corners.size() == targets_.views()) && "a list a view");
    hidden_.set(device_, corners);
}

void SetRaster::catch_shadows(std::optional<double> floor_m) {
    const bool had_transparent = has_transparent();
    catcher_.set_floor(device_, lighting, floor_m);
    clear_front(had_transparent);
}

void SetRaster::clear_front(bool had_transparent) {
    if (had_transparent && !has_transparent())
        gpu::run_once(device_, "set front", [&](gpu::Commands& commands) { gpu::fill(commands, targets_.front, 0); });
}

void SetRaster::record_shadows(gpu::Commands& commands) {
    if (catcher_.has_floor()) return;
    lighting.record_shadow_maps(commands, [&](const SetPush& push) { meshes_.draw_shadowing(commands, push); });
}

void SetRaster::record_solid(gpu::Commands& commands, std::span<const stage::Camera> cameras) {
    assert(cameras.size() <= targets_.views() && "one camera a view");
    gpu::draw_barrier(commands);
    for (uint32_t view = 0; view < cameras.size(); ++view) record_view(commands, cameras[view], view);
    gpu::compute_barrier(commands);
}

void SetRaster::record_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view) {
    const gpu::PassScope scope(commands, "set");
    begin_solid(commands, targets_, camera, view);
    hidden_.draw(commands, view);
    if (catcher_.has_floor()) {
        catcher_.draw(commands, push_of(camera, view));
    } else {
        meshes_.draw_solid(commands, push_of(camera, view));
        if (lighting.shows_environment())
            draw_background(commands, background_, glm::mat4(glm::inverse(clip_from_world(camera, kSetNear_m))));
    }
    end_solid(commands, targets_, camera, view);
}

void SetRaster::record_transparent(gpu::Commands& commands, std::span<const stage::Camera> cameras) {
    if (!has_transparent()) return;
    assert(cameras.size() <= targets_.views() && "one camera a view");
    gpu::draw_barrier(commands);
    for (uint32_t view = 0; view < cameras.size(); ++view) {
        const gpu::PassScope scope(commands, "set transparent");
        begin_blended(commands, targets_, cameras[view], view);
        meshes_.draw_blended(commands, push_of(cameras[view], view));
        end_blended(commands, targets_, cameras[view], view);
    }
    gpu::compute_barrier(commands);
}

SetPush SetRaster::push_of(const stage::Camera& camera, uint32_t view) const {
    assert(camera.width <= targets_.width && camera.height <= targets_.height && "the size of the set's images");
    SetPush push{};
    push.clip_from_world = glm::mat4(clip_from_world(camera, kSetNear_m));
    push.eye = glm::vec4(camera.world_from_camera[3]);
    push.first_texel = view * camera.width * camera.height;
    push.width = camera.width;
    return push;
}

}  // namespace neuvv::render
