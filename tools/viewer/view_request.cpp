#include "tools/viewer/view_request.h"

#include <algorithm>
#include <cmath>

#include "media/colour.h"

namespace neuvv::viewer {

editor::ViewRequest requested_view(const FrameInput& input, const ViewState& state, bool moving) {
    const editor::StageClock& clock = state.clock;
    editor::ViewRequest view;
    view.camera = input.camera;
    view.time_s = clock.displayed_s();
    view.resolve.show = state.image.show;
    view.resolve.cost_max = state.image.cost_max;
    view.overrides_background = state.image.overrides_background;
    view.resolve.background = glm::vec4(media::linear_from_srgb(state.image.background), 1);
    view.moving = moving;
    view.max_scale = state.image.max_scale;
    view.samples = static_cast<uint32_t>(state.image.samples);
    view.far_levels = state.image.far_levels;
    const auto [low, high] = stage::performers_box(*input.stage, input.evaluated);
    const double distance = distance_to(input.camera.world_from_camera, low, high), size = glm::length(high - low);
    view.resolve.depth_near_m = static_cast<float>(std::max(0.0, distance - size));
    view.resolve.depth_far_m = static_cast<float>(distance + size);
    // Where the device is too slow to draw every frame, it is not known which times will be displayed next.
    const bool keeps_pace = input.rendered.displayed.milliseconds * clock.fps() * std::abs(clock.speed) < 1000;
    if (clock.playing && keeps_pace)
        for (int32_t i = 1; i <= 2; ++i) view.next_s.push_back(clock.displayed_after_s(i));
    return view;
}

bool is_same_image(const editor::ViewRequest& a, const editor::ViewRequest& b) {
    return a.camera.world_from_camera == b.camera.world_from_camera && a.camera.fx == b.camera.fx &&
           a.camera.fy == b.camera.fy && a.camera.cx == b.camera.cx && a.camera.cy == b.camera.cy &&
           a.camera.width == b.camera.width && a.camera.height == b.camera.height && a.time_s == b.time_s &&
           a.resolve == b.resolve && a.highlight == b.highlight && a.overrides_background == b.overrides_background &&
           a.moving == b.moving && a.max_scale == b.max_scale && a.samples == b.samples && a.far_levels == b.far_levels;
}

}  // namespace neuvv::viewer
