// Frame plan: what a frame draws: the rays of its views, and the visible instances in their order.
#pragma once

#include <span>
#include <vector>

#include "render/frame/frame_settings.h"
#include "render/frame/slice_residency.h"
#include "render/volume/instance_cameras.h"

namespace neuvv::render {

struct FramePlan {
    ViewLayout layout;                              // of the rays and of the pixels in their buffers
    std::vector<RayGrid> grids;                     // of the views, where the image is upscaled
    std::vector<stage::Camera> set_cameras;         // of the views, with a pixel for each ray of an image
    std::vector<std::vector<DrawnInstance>> drawn;  // near to far, in groups that are merged (draw_order.h)
};

// Whether images have fewer rays than pixels.
bool is_upscaled(const FrameSettings& settings);

// Throws RuntimeFailure for more than kMaxInstances instances, cameras of another size than the images, fields from
// `fields` on, frames that are not finite, and transforms that cannot be inverted.
void expect_drawable(std::span<const stage::Camera> cameras, const FrameSettings& settings, uint32_t fields);

// Plans all but `drawn`. The views have as many rays as the one with the most.
void plan_views(FramePlan& plan, std::span<const stage::Camera> cameras, const FrameSettings& settings);
// Plans `drawn`, and writes the cameras of instances into the target; `views` has the layout and the grids of the plan.
// Instances refer to fields of levels.all.
void plan_instances(FramePlan& plan, const TargetViews& views, const FrameSettings& settings, const FieldLevels& levels,
                    bool has_set);

// The slices for a planned frame, for instances that only cast shadows, and for the next images. Those of highlighted
// instances come first, as they need slices, and those of shadows last, as a missing slice matters less there.
SliceRequests slice_requests(const FramePlan& plan, std::span<const DrawnInstance> shadows,
                             std::span<const Instance> next, const FieldLevels& levels);

}  // namespace neuvv::render
