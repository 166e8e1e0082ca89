// How fast the viewer is: images per second, and how long it takes from an event to the image that answers it.
#pragma once

#include <cstdint>
#include <deque>

namespace neuvv::viewer {

// All times in seconds of FrameInput::now_s.
class FrameMeter {
  public:
    // The number of the view and of the document that were requested last, or that are displayed.
    struct Numbers {
        uint64_t view = 0, document = 0;
        bool operator==(const Numbers&) const = default;
    };

    // Each frame: which view is displayed.
    void count(uint64_t displayed_view, double now_s);
    // An event that came at `event_s` is answered by what was requested since.
    void request(const Numbers& requested, double event_s);
    // What waits for files that are read does not count.
    void forget_requests() { requests_.clear(); }
    // The frame that displays these numbers has ended.
    void displayed(const Numbers& numbers, double now_s);
    // How long the window's thread took for a frame.
    void frame(double seconds, bool counts);

    double images_per_second() const { return images_per_second_; }  // the mean of the last second
    double latency_ms() const { return latency_ms_; }                // of the last event
    double max_latency_ms() const { return max_latency_ms_; }
    double frame_ms() const { return frame_ms_; }
    double max_frame_ms() const { return max_frame_ms_; }

  private:
    struct Request {
        Numbers numbers;
        double event_s = 0;
    };
    std::deque<Request> requests_;
    std::deque<double> image_times_s_;
    uint64_t counted_view_ = 0;
    double images_per_second_ = 0, latency_ms_ = 0, max_latency_ms_ = 0, frame_ms_ = 0, max_frame_ms_ = 0;
};

}  // namespace neuvv::viewer
