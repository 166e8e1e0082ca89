// Place: an instance's cameras in the views of a frame.
#pragma once

#include <optional>

#include "render/performer.h"
#include "render/ray_grid.h"

namespace neuvv::render {

// The views of a target in one frame.
struct TargetViews {
    const RayTarget& target;
    const ViewLayout& layout;
    std::span<const stage::Camera> cameras;  // world; one a view
    std::span<const RayGrid> grids{};        // one a view where layout.upscaled()
    double scale = 1;                        // rays a pixel, along each side, where that is so
};

// Of the world, or of a camera in a performer's space.
ShaderCamera shader_camera_of(const TargetViews& views, const stage::Camera& camera, uint32_t view);

// The cameras of the world, one a view; and, as ray tiles of the layout, their tiles.
void write_cameras(const TargetViews& views);
void write_tiles(const TargetViews& views);

// Puts the instance's cameras behind those of `place` others. Nothing where no view can see it. Its frame is held
// within the clip's; it is shaded a leaf where play_shading says so for all views.
std::optional<DrawnInstance> write_instance_cameras(const TargetViews& views, const Field& field,
                                                    const Instance& instance, uint32_t place);

}  // namespace neuvv::render
