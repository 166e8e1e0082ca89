#include "editor/clock.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace neuvv::editor {

namespace {

constexpr double kOnFrame = 1e-6;  // frames: a time that is nearer to a frame than this is on the frame

// The number of frames that begin before a time.
int64_t frames_before(double time_s, double fps) {
    return static_cast<int64_t>(std::ceil(time_s * fps - kOnFrame));
}

// `value` modulo `length`, in [0, length).
double wrapped(double value, double length) {
    const double rest = std::fmod(value, length);
    const double positive = rest < 0 ? rest + length : rest;
    return positive < length ? positive : 0;
}

}  // namespace

void StageClock::set_stage(double duration_s, double fps) {
    assert(duration_s >= 0 && fps > 0 && std::isfinite(duration_s) && std::isfinite(fps));
    const bool whole = in_s_ == 0 && out_s_ == duration_s_;
    duration_s_ = duration_s;
    fps_ = fps;
    time_s_ = std::min(time_s_, duration_s);
    if (whole)
        in_s_ = 0, out_s_ = duration_s;
    else
        set_range(in_s_, out_s_);
}

double StageClock::displayed_step_s() const {
    return std::min(1.0, std::abs(speed)) / fps_;
}

double StageClock::displayed_s() const {
    const double step_s = displayed_step_s();
    if (!playing || !(step_s > 0)) return time_s_;
    return std::max(std::floor(time_s_ / step_s + kOnFrame) * step_s, std::min(time_s_, in_s_));
}

double StageClock::displayed_after_s(int32_t n) const {
    StageClock after = *this;
    after.time_s_ = displayed_s();
    if (playing && speed != 0) after.tick(n * displayed_step_s() / std::abs(speed));
    return after.displayed_s();
}

int64_t StageClock::frame() const {
    const auto at = static_cast<int64_t>(std::floor(time_s_ * fps_ + kOnFrame));
    return std::min(at, frames() - 1);
}

int64_t StageClock::frames() const {
    return std::max<int64_t>(1, frames_before(duration_s_, fps_));
}

int64_t StageClock::first_in_range() const {
    return frames_before(in_s_, fps_);
}

int64_t StageClock::last_in_range() const {
    return std::max(first_in_range(), frames_before(out_s_, fps_) - 1);
}

void StageClock::set_range(double in_s, double out_s) {
    if (!std::isfinite(in_s) || !std::isfinite(out_s)) return;
    in_s_ = std::clamp(std::min(in_s, out_s), 0.0, duration_s_);
    out_s_ = std::clamp(std::max(in_s, out_s), 0.0, duration_s_);
    const double shortest = std::min(1 / fps_, duration_s_);
    if (out_s_ - in_s_ >= shortest) return;
    in_s_ = std::min(in_s_, duration_s_ - shortest);
    out_s_ = in_s_ + shortest;
}

void StageClock::pause() {
    time_s_ = displayed_s();
    playing = false;
}

double StageClock::until_next_s() const {
    const double step_s = displayed_step_s();
    if (!playing || !(step_s > 0)) return std::numeric_limits<double>::infinity();
    const double steps = time_s_ / step_s, since = steps - std::floor(steps + kOnFrame);
    return std::max(0.0, speed > 0 ? 1 - since : since) * step_s / std::abs(speed);
}

void StageClock::play_or_pause() {
    time_s_ = displayed_s();  // the time that was displayed last
    playing = !playing;
    if (!playing || loops) return;
    if (speed > 0 && frame() == last_in_range()) time_s_ = in_s_;
    if (speed < 0 && frame() == first_in_range()) time_s_ = static_cast<double>(last_in_range()) / fps_;
}

void StageClock::tick(double real_s) {
    const double moved_s = real_s * speed;
    if (!playing || !(real_s > 0) || !std::isfinite(moved_s) || out_s_ <= in_s_) return;
    const double time_s = time_s_ + moved_s;
    const bool ends = moved_s > 0 ? time_s >= out_s_ : moved_s < 0 && time_s < in_s_;
    if (!ends) {
        time_s_ = time_s;
    } else if (loops) {
        time_s_ = in_s_ + wrapped(time_s - in_s_, out_s_ - in_s_);
        if (time_s_ >= out_s_) time_s_ = in_s_;
    } else {
        time_s_ = static_cast<double>(moved_s > 0 ? last_in_range() : first_in_range()) / fps_;
        playing = false;
    }
}

void StageClock::step(int32_t by) {
    pause();
    const double at = time_s_ * fps_, nearest = std::round(at);
    const bool on_frame = std::abs(at - nearest) < kOnFrame;
    const auto from = static_cast<int64_t>(on_frame ? nearest : by > 0 ? std::floor(at) : std::ceil(at));
    int64_t to = from + by;
    const int64_t first = first_in_range(), last = last_in_range(), count = last - first + 1;
    const bool in_range = at >= in_s_ * fps_ - kOnFrame && at < out_s_ * fps_ - kOnFrame;
    if (!in_range)
        to = std::clamp<int64_t>(to, 0, frames() - 1);
    else if (loops)
        to = first + ((to - first) % count + count) % count;
    else
        to = std::clamp(to, first, last);
    time_s_ = static_cast<double>(to) / fps_;
}

void StageClock::scrub(double time_s) {
    if (std::isfinite(time_s)) time_s_ = std::clamp(time_s, 0.0, duration_s_);
}

}  // namespace neuvv::editor
