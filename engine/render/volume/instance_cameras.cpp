#include "render/volume/instance_cameras.h"

#include "render/volume/tile_range.h"

#include <algorithm>

namespace neuvv::render {

ShaderCamera shader_camera_of(const TargetViews& views, const stage::Camera& camera, uint32_t view) {
    const uint32_t samples = views.layout.samples;
    return views.layout.upscaled() ? shader_camera(camera, views.grids[view])
                                   : shader_camera(stage::enlarged(camera, samples), samples);
}

void write_cameras(const TargetViews& views) {
    views.target.used_cameras = 0;
    for (uint32_t view = 0; view < views.layout.views; ++view)
        views.target.set_camera(view, shader_camera_of(views, views.cameras[view], view));
}

void write_tiles(const TargetViews& views) {
    Tile* to = views.target.rays.tiles.as<Tile>();
    for (uint32_t view = 0; view < views.layout.views; ++view) {
        const std::vector<Tile> tiles = tiles_of_image(view, views.layout.rays_across(), views.layout.rays_down());
        to = std::copy(tiles.begin(), tiles.end(), to);
    }
}

std::optional<DrawnInstance> write_instance_cameras(const TargetViews& views, const Field& field,
                                                    const Instance& instance, uint32_t index) {
    const ViewLayout& layout = views.layout;
    DrawnInstance drawn;
    drawn.field = instance.field;
    drawn.paint = instance.paint;
    drawn.frame = std::clamp(instance.frame, 0.0f, static_cast<float>(field.frames - 1));
    drawn.shading = Shading::kPerLeaf;
    drawn.rays.first_camera = layout.views * (index + 1);
    drawn.rays.opacity = instance.opacity;
    drawn.rays.density = instance.density;
    const double pixel_rays = layout.samples * views.scale;  // along each side
    bool visible = false;
    for (uint32_t view = 0; view < layout.views; ++view) {
        const stage::Camera camera = in_performer(views.cameras[view], instance.world_from_performer);
        const glm::vec3 eye(camera.world_from_camera[3]);
        const ShaderCamera shader_camera = shader_camera_of(views, camera, view);
        const RangeView range = range_view(shader_camera);
        const glm::dvec2 image = static_cast<double>(layout.samples) * glm::dvec2(camera.width, camera.height);
        const double rays =
            pixels_covered(range, image, field.leaves_min, field.leaves_max) * views.scale * views.scale;
        views.target.set_camera(drawn.rays.first_camera + view, shader_camera, range);
        const uint32_t level = range_level(field, eye, pixel_rays * std::max(camera.fx, camera.fy));
        drawn.range_level = std::max(drawn.range_level, level);
        if (play_shading(field, eye, rays) == Shading::kPerRay) drawn.shading = Shading::kPerRay;
        visible |= rays > 0;
    }
    if (!visible || instance.opacity <= 0 || instance.density <= 0) return std::nullopt;
    return drawn;
}

}  // namespace neuvv::render
