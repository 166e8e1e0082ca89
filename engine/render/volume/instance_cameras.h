// The cameras and tiles of a frame's views, and the cameras of its instances, set in a ray target.
#pragma once

#include <optional>

#include "render/rays/ray_grid.h"
#include "render/rays/view_layout.h"
#include "render/volume/performer.h"

namespace neuvv::render {

// The views of a target in one frame.
struct TargetViews {
    RayTarget& target;
    const ViewLayout& layout;
    std::span<const stage::Camera> cameras;  // world; one per view
    std::span<const RayGrid> grids{};        // one per view where layout.upscaled(), else none
    double scale = 1;                        // rays per pixel along each side where layout.upscaled(), else 1
};

// The camera as shaders take it, with the ray grid of the view. It may be in the world or in a performer's space.
ShaderCamera shader_camera_of(const TargetViews& views, const stage::Camera& camera, uint32_t view);

// Sets the cameras of the views, in world space, as the first cameras of the target, and no others: those of instances
// follow.
void write_cameras(const TargetViews& views);
// Writes the ray tiles of all views to the device. No submitted work may read them meanwhile.
void write_tiles(const TargetViews& views);

// Sets the cameras of an instance in the performer's space, one per view, and their RangeViews, behind those of the
// world and of `index` other instances. Returns how the instance is drawn, or nothing where no view can see it or its
// opacity is 0. Its frame is clamped to the clip. It is shaded per leaf where play_shading says so for every view.
std::optional<DrawnInstance> write_instance_cameras(const TargetViews& views, const Field& field,
                                                    const Instance& instance, uint32_t index);

}  // namespace neuvv::render
