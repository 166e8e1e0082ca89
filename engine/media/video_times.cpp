#include "media/video_times.h"

#include <algorithm>
#include <cmath>

#include "media/video_input.h"

extern "C" {
#include <libavutil/timecode.h>
}

namespace neuvv::media {

namespace {

constexpr double kSameRate = 5e-4;  // half of what tells 30 from 29.97 frames a second
constexpr double kRounding = 1e-6;
constexpr double kEven = 0.1;  // of a step, by which even times may be off
constexpr uint32_t kTimecodeTag = MKTAG('t', 'm', 'c', 'd');

bool is_rate(AVRational rate) {
    return rate.num > 0 && rate.den > 0;
}

// The times of frames whose decoding times, which the index has, are even and hence those of their display, too. Empty
// where they are not, or where an edit list cuts. In ticks as long as a frame, a lacking frame is off by less than one.
std::vector<double> times_by_index(const VideoInput& input) {
    const std::vector<const AVIndexEntry*> frames = input.frames();
    if (frames.size() < 2 || input.stream().start_time == AV_NOPTS_VALUE) return {};
    const int64_t first = frames.front()->timestamp;
    const double step = static_cast<double>(frames.back()->timestamp - first) / static_cast<double>(frames.size() - 1);
    const double slack = std::min(1.0, kEven * step);
    std::vector<double> times;
    for (const AVIndexEntry* frame : frames) {
        const double after = step * static_cast<double>(times.size());
        if (!is_shown(*frame) || std::abs(static_cast<double>(frame->timestamp - first) - after) > slack) return {};
        times.push_back((static_cast<double>(input.stream().start_time) + after) * av_q2d(input.stream().time_base));
    }
    return step > 0 ? times : std::vector<double>();
}

// By the packets' times of display; where one has none, as of H.264 in an .avi, by those of decoding, which are the
// same but for their order; where one has neither, at an even rate.
std::vector<double> times_by_packets(VideoInput& input) {
    std::vector<int64_t> shown, decoded;
    while (const AVPacket* packet = input.read()) {
        if (!is_shown(*packet)) continue;
        shown.push_back(packet->pts);
        decoded.push_back(packet->dts);
    }
    const auto lacks_times = [](const std::vector<int64_t>& of) { return std::ranges::count(of, AV_NOPTS_VALUE) > 0; };
    const std::vector<int64_t>& ticks = lacks_times(shown) ? decoded : shown;
    const AVRational rate = input.stream().avg_frame_rate;
    const bool even = lacks_times(ticks);
    std::vector<double> times;
    for (const int64_t tick : ticks)
        times.push_back(!even           ? static_cast<double>(tick) * av_q2d(input.stream().time_base)
                        : is_rate(rate) ? static_cast<double>(times.size()) / av_q2d(rate)
                                        : static_cast<double>(times.size()));
    std::ranges::sort(times);
    return times;
}

// The rate of the timecode is that of its own track, where there is one: cameras of 50 frames a second often count 25.
std::optional<double> timecode_of(const VideoInput& input, double fps) {
    const AVDictionaryEntry* text = av_dict_get(input.stream().metadata, "timecode", nullptr, 0);
    if (!text) text = av_dict_get(input.context().metadata, "timecode", nullptr, 0);
    AVRational rate = av_d2q(fps, 100'000);
    for (unsigned i = 0; i < input.context().nb_streams; ++i) {
        const AVStream& track = *input.context().streams[i];
        if (track.codecpar->codec_tag != kTimecodeTag) continue;
        if (is_rate(track.avg_frame_rate)) rate = track.avg_frame_rate;
        if (!text) text = av_dict_get(track.metadata, "timecode", nullptr, 0);
    }
    AVTimecode code{};
    if (!text || rate.num <= 0 || rate.den <= 0 || av_timecode_init_from_string(&code, rate, text->value, nullptr) < 0)
        return {};
    return code.start / av_q2d(rate);
}

// Whether frames of this rate, most of which follow each other, are shown at these times, to a tick.
bool are_of_rate(const std::vector<double>& times_s, double fps, double tick_s) {
    double last = 0;
    size_t next = 0;
    for (size_t i = 1; i < times_s.size(); ++i) {
        const double at = (times_s[i] - times_s[0]) * fps, frame = std::round(at);
        if (frame <= last || std::abs(at - frame) > tick_s * fps + kRounding) return false;
        next += frame == last + 1;
        last = frame;
    }
    return 2 * next + 1 > times_s.size();
}

// That which the file names, where it is that of its times. Its average is none that counts: a lacking frame lowers it.
double recorded_rate(const AVStream& stream, const std::vector<double>& times_s) {
    const double tick_s = av_q2d(stream.time_base), counted = rate_of(times_s, tick_s);
    if (counted == 0) return is_rate(stream.avg_frame_rate) ? av_q2d(stream.avg_frame_rate) : 0;
    if (!is_rate(stream.r_frame_rate)) return counted;
    const double named = av_q2d(stream.r_frame_rate);
    return are_of_rate(times_s, named, tick_s) || std::abs(named / counted - 1) < kSameRate ? named : counted;
}

}  // namespace

double rate_of(const std::vector<double>& times_s, double tick_s) {
    std::vector<double> gaps;
    for (size_t i = 1; i < times_s.size(); ++i) gaps.push_back(times_s[i] - times_s[i - 1]);
    if (gaps.empty()) return 0;
    const auto centre = gaps.begin() + static_cast<ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), centre, gaps.end());
    const double median = *centre;
    if (!(median > 0)) return 0;
    const auto is_usual = [&](double gap) { return std::abs(gap - median) <= tick_s + kRounding * median; };
    double sum = 0, count = 0;
    for (const double gap : gaps)
        if (is_usual(gap)) sum += gap, ++count;
    const double usual = sum / count;
    double steps = 0;  // a lacking frame makes two
    for (const double gap : gaps) steps += is_usual(gap) ? 1 : std::round(gap / usual);
    return steps / (times_s.back() - times_s.front());
}

VideoTimes video_times(const std::filesystem::path& path) {
    VideoInput input(path);
    VideoTimes result;
    result.shown_s = times_by_index(input);
    if (result.shown_s.empty()) result.shown_s = times_by_packets(input);
    // A transport stream is cut out of a clock that runs on, which says nothing about other files.
    if (input.context().iformat->flags & AVFMT_TS_DISCONT && !result.shown_s.empty())
        for (const double first = result.shown_s[0]; double& time : result.shown_s) time -= first;
    result.fps = recorded_rate(input.stream(), result.shown_s);
    result.timecode_s = timecode_of(input, result.fps);
    return result;
}

}  // namespace neuvv::media
