#include "training/data/layouts/rig/clip_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "base/error.h"

namespace neuvv::training {

namespace {

constexpr double kSameRate = 5e-3;    // 29.97 and 30 frames a second are one rate, 24 and 25 are not
constexpr double kSlack = 1e-3;       // of a frame: what times are rounded by
constexpr double kNoticeable = 0.25;  // of a frame, by which images are off
constexpr size_t kMaxGaps = 8;        // that a remark names
constexpr double kDay_s = 86400;
constexpr char kWithoutTimecode[] =
    "remove them by `ffmpeg -i in.mp4 -map 0:v -map_metadata -1 -c copy -write_tmcd 0 out.mp4` to align first frames";

bool is_same_rate(double a, double b) {
    return std::abs(a - b) <= kSameRate * std::max(a, b);
}

// The rate that most videos have, of those that are nearly the same the middle one; of equally frequent ones, the
// lowest.
double rate_of_most(const std::vector<ClipVideo>& videos) {
    std::vector<double> best;
    for (const ClipVideo& video : videos) {
        std::vector<double> alike;
        for (const ClipVideo& other : videos)
            if (is_same_rate(other.times.fps, video.times.fps)) alike.push_back(other.times.fps);
        std::ranges::sort(alike);
        if (alike.size() > best.size() || (alike.size() == best.size() && alike < best)) best = std::move(alike);
    }
    return best.empty() ? 0 : best[(best.size() - 1) / 2];
}

// "frames 2, 5 to 7".
std::string frames_text(const std::vector<int64_t>& numbers) {
    std::vector<std::string> parts;
    size_t left = 0;
    for (size_t i = 0; i < numbers.size();) {
        size_t end = i + 1;
        while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
        if (parts.size() == kMaxGaps)
            left += end - i;
        else
            parts.push_back(end - i > 2
                                ? fmt::format("{} to {}", numbers[i], numbers[end - 1])
                                : fmt::format("{}", fmt::join(numbers.begin() + static_cast<ptrdiff_t>(i),
                                                              numbers.begin() + static_cast<ptrdiff_t>(end), ", ")));
        i = end;
    }
    return fmt::format("frame{} {}{}", numbers.size() > 1 ? "s" : "", fmt::join(parts, ", "),
                       left ? fmt::format(" and {} more", left) : "");
}

class Clip {
  public:
    explicit Clip(const std::vector<ClipVideo>& videos) : videos_(videos) {
        result_.fps = rate_of_most(videos);
        by_timecode_ = std::ranges::all_of(videos, [](const ClipVideo& v) { return v.times.timecode_s.has_value(); });
        start_s_ = 1e300;
        for (const ClipVideo& video : videos)
            if (!video.times.shown_s.empty()) start_s_ = std::min(start_s_, time_of(video, 0));
        start_s_ += usual_phase() / rate();
        for (const ClipVideo& video : videos) number(video);
        say_starts();
        cut_ends();
        for (size_t v = 0; v < videos.size(); ++v) say_gaps(v);
        say_jumps();
    }
    ClipTimes take() { return std::move(result_); }

  private:
    double time_of(const ClipVideo& video, size_t frame) const {
        const std::vector<double>& times = video.times.shown_s;
        if (!by_timecode_) return times[frame];
        // Timecodes begin anew at midnight.
        const double days = std::round((*video.times.timecode_s - *videos_[0].times.timecode_s) / kDay_s);
        return *video.times.timecode_s - days * kDay_s + times[frame] - times[0];
    }

    double rate() const { return result_.fps > 0 ? result_.fps : 1; }

    // Where frames lie between the moments that begin with the earliest frame, as a share of a frame: a circular mean,
    // so that neither a first frame that is off nor jitter tears frames apart that belong together.
    double usual_phase() const {
        std::complex<double> sum = 0;
        for (const ClipVideo& video : videos_)
            for (size_t i = 0; is_same_rate(video.times.fps, result_.fps) && i < video.times.shown_s.size(); ++i)
                sum += std::polar(1.0, 2 * std::numbers::pi * (time_of(video, i) - start_s_) * rate());
        return std::arg(sum) / (2 * std::numbers::pi);
    }

    // Of two frames that are nearest to one moment, the nearer one has its number.
    void number(const ClipVideo& video) {
        const double reach = 0.5 * std::min(1.0, rate() / std::max(video.times.fps, 1e-9)) + kSlack;
        std::vector<int64_t> numbers(video.times.shown_s.size(), kNotInClip);
        std::map<int64_t, std::pair<double, size_t>> nearest;  // of a number: how far the frame is, and which it is
        double farthest = 0;
        for (size_t i = 0; i < numbers.size(); ++i) {
            const double at = (time_of(video, i) - start_s_) * rate(), moment = std::floor(at + 0.5);
            const double off = std::abs(at - moment);
            if (off > reach) continue;
            const auto [entry, fresh] = nearest.try_emplace(static_cast<int64_t>(moment), off, i);
            if (!fresh && entry->second.first > off) entry->second = {off, i};
        }
        for (const auto& [moment, frame] : nearest) {
            numbers[frame.second] = moment;
            farthest = std::max(farthest, frame.first);
            ++seen_by_[moment];
        }
        if (farthest > kNoticeable)
            result_.texts.emplace_back(
                video.name, fmt::format("images up to {:.0f} ms from the clip's times", 1000 * farthest / rate()));
        if (!is_same_rate(video.times.fps, rate()))
            result_.texts.emplace_back(
                video.name,
                fmt::format("{:.4g} frames a second, in a clip of {:.4g}{}", video.times.fps, rate(),
                            nearest.size() < numbers.size() ? ", for which the images between are left out" : ""));
        else if (nearest.size() < numbers.size())
            result_.texts.emplace_back(
                video.name, fmt::format("{} images at the times of others, left out", numbers.size() - nearest.size()));
        result_.frames.push_back(std::move(numbers));
    }

    void say_starts() {
        if (by_timecode_ && videos_.size() > 1)
            result_.remarks.push_back(fmt::format("videos are aligned by their timecodes: {}", kWithoutTimecode));
        else
            for (const ClipVideo& video : videos_)
                if (video.times.timecode_s)
                    result_.texts.emplace_back(video.name, "timecode not used, as other videos have none");
    }

    [[noreturn]] void fail() const {
        std::vector<std::string> starts;
        for (const ClipVideo& video : videos_)
            if (!video.times.shown_s.empty() && starts.size() < kMaxGaps)
                starts.push_back(fmt::format("{} at {:.2f} s", video.name, time_of(video, 0) - start_s_));
        throw InputError(videos_[0].path.string(), "",
                         fmt::format("no moment is shown by half of the videos: by their {} they begin {}",
                                     by_timecode_ ? "timecodes" : "time stamps", fmt::join(starts, ", ")),
                         by_timecode_ ? fmt::format("where these are wrong, {}", kWithoutTimecode)
                                      : "give videos that were recorded at the same time");
    }

    void cut_ends() {
        const auto is_seen = [&](const auto& seen) { return 2 * seen.second >= static_cast<int64_t>(videos_.size()); };
        const auto first = std::ranges::find_if(seen_by_, is_seen);
        if (first == seen_by_.end()) fail();
        const auto last = std::find_if(seen_by_.rbegin(), seen_by_.rend(), is_seen);
        std::vector<int64_t> cut;
        for (const auto& [moment, count] : seen_by_)
            if (moment < first->first || moment > last->first) cut.push_back(moment);
        if (cut.empty()) return;
        for (std::vector<int64_t>& numbers : result_.frames)
            for (int64_t& moment : numbers)
                if (moment < first->first || moment > last->first) moment = kNotInClip;
        result_.remarks.push_back(
            fmt::format("left out: {}, which fewer than half of the videos show", frames_text(cut)));
        const int64_t from = first->first, to = last->first;
        std::erase_if(seen_by_, [&](const auto& seen) { return seen.first < from || seen.first > to; });
    }

    void say_gaps(size_t v) {
        const std::set<int64_t> has(result_.frames[v].begin(), result_.frames[v].end());
        std::vector<int64_t> gaps;
        for (const auto& [moment, count] : seen_by_)
            if (!has.contains(moment)) gaps.push_back(moment);
        if (!gaps.empty()) result_.texts.emplace_back(videos_[v].name, "no image at " + frames_text(gaps));
    }

    // Moments that no video shows are no frames of the clip.
    void say_jumps() {
        std::vector<std::string> jumps;
        size_t left = 0;
        int64_t next = seen_by_.begin()->first;  // the moment behind the one before
        for (const auto& [moment, count] : seen_by_) {
            if (moment > next && jumps.size() == kMaxGaps)
                ++left;
            else if (moment > next + 1)
                jumps.push_back(
                    fmt::format("{:.2f} s (frames {} to {})", static_cast<double>(next) / rate(), next, moment - 1));
            else if (moment > next)
                jumps.push_back(fmt::format("{:.2f} s (frame {})", static_cast<double>(next) / rate(), next));
            next = moment + 1;
        }
        if (!jumps.empty())
            result_.remarks.push_back(fmt::format("no camera has an image at {}{}: the clip jumps there",
                                                  fmt::join(jumps, ", "),
                                                  left ? fmt::format(" and at {} more times", left) : ""));
    }

    const std::vector<ClipVideo>& videos_;
    ClipTimes result_;
    bool by_timecode_ = false;
    double start_s_ = 0;                  // of the clip's frame 0
    std::map<int64_t, int64_t> seen_by_;  // by the clip's frame: how many videos show it
};

}  // namespace

ClipTimes clip_times(const std::vector<ClipVideo>& videos) {
    return Clip(videos).take();
}

}  // namespace neuvv::training
