// Measures how fast the viewer is: images per second, and the latency from an event to the image that shows its effect.
#pragma once

#include <cstdint>
#include <deque>

#include "editor/draw/render_thread.h"

namespace neuvv::viewer {

// Times in seconds, as FrameInput::now_s.
class FrameMeter {
  public:
    // Identifies a view (ViewRequest::id) and a document (Editor::id()).
    struct Ids {
        uint64_t view = 0, document = 0;
        bool operator==(const Ids&) const = default;
    };

    // To be called once a frame, with the view that is displayed.
    void count_image(uint64_t displayed_view, double now_s);
    // An event at `event_s` had the effect that this view and document were requested. The latency of the event ends
    // when they, or newer ones, are displayed.
    void request(const Ids& requested, double event_s);
    // To be called at the end of each frame, with what it displayed and when it began. Requests that wait are dropped
    // while files are read: the latency is not measured then.
    void end_frame(const editor::RenderThreadState& rendered, double begin_s, double now_s);

    double images_per_second() const { return images_per_second_; }  // the mean over the last second
    double latency_ms() const { return latency_ms_; }                // of the last event whose effect is displayed
    double max_latency_ms() const { return max_latency_ms_; }
    double frame_ms() const { return frame_ms_; }  // that the window's thread needed for the last frame
    double max_frame_ms() const { return max_frame_ms_; }

  private:
    struct Request {
        Ids ids;
        double event_s = 0;
    };
    std::deque<Request> requests_;
    std::deque<double> image_times_s_;
    uint64_t counted_view_ = 0;
    double images_per_second_ = 0, latency_ms_ = 0, max_latency_ms_ = 0, frame_ms_ = 0, max_frame_ms_ = 0;
};

}  // namespace neuvv::viewer
