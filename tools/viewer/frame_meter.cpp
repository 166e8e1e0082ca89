#include "tools/viewer/frame_meter.h"

#include <algorithm>

namespace neuvv::viewer {

void FrameMeter::count_image(uint64_t displayed_view, double now_s) {
    constexpr double kWindow_s = 1;
    if (displayed_view != counted_view_) image_times_s_.push_back(now_s);
    counted_view_ = displayed_view;
    while (!image_times_s_.empty() && now_s - image_times_s_.front() > kWindow_s) image_times_s_.pop_front();
    const double seconds = image_times_s_.empty() ? 0 : image_times_s_.back() - image_times_s_.front();
    images_per_second_ = seconds > 0 ? static_cast<double>(image_times_s_.size() - 1) / seconds : 0;
}

void FrameMeter::request(const Ids& requested, double event_s) {
    requests_.push_back({requested, event_s});
}

void FrameMeter::end_frame(const editor::RenderThreadState& rendered, double begin_s, double now_s) {
    const editor::DisplayedImage& displayed = rendered.displayed;
    frame_ms_ = 1000 * (now_s - begin_s);
    if (displayed.view > 0) max_frame_ms_ = std::max(max_frame_ms_, frame_ms_);
    if (!rendered.loading.empty() || !rendered.problem.empty()) requests_.clear();
    while (!requests_.empty() && requests_.front().ids.view <= displayed.view &&
           requests_.front().ids.document <= displayed.stage) {
        latency_ms_ = 1000 * (now_s - requests_.front().event_s);
        max_latency_ms_ = std::max(max_latency_ms_, latency_ms_);
        requests_.pop_front();
    }
}

}  // namespace neuvv::viewer
