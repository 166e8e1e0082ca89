#include <algorithm>
#include <cmath>
#include <span>

#include "stage/sound/heard_peaks.h"
#include "tools/viewer/timeline/timeline_view.h"

namespace neuvv::viewer {

namespace {

constexpr unsigned kWave = 0xa0d8b87a, kWaveMuted = 0x38b0b0b0;

bool same_axis(const TimeAxis& a, const TimeAxis& b) {
    return a.left == b.left && a.width == b.width && a.begin_s == b.begin_s && a.s_per_px == b.s_per_px;
}

// The amplitude of each column of pixels of the axis. They are computed when the waveform or the axis has changed; the
// panel forgets them when a time map may have.
std::span<const float> amplitudes_of(TimelineState& state, const edit::PerformerTrack& track,
                                     std::shared_ptr<const media::SoundPeaks> peaks) {
    WaveformColumns& columns = state.waveforms[track.node];
    const TimeAxis& axis = state.view.axis;
    if (columns.peaks == peaks && same_axis(columns.axis, axis)) return columns.amplitudes;
    columns.amplitudes.resize(static_cast<size_t>(std::max(1.0, std::ceil(axis.width))));
    stage::heard_peaks(*peaks, track.timeline, axis.begin_s, axis.s_per_px, columns.amplitudes);
    columns.peaks = std::move(peaks);
    columns.axis = axis;
    return columns.amplitudes;
}

// The height of an amplitude above the centre, in whole pixels up to `max`. A square root, so that speech can be seen
// beside claps that are ten times as loud.
float height_of(float amplitude, float gain, float max) {
    return std::round(max * std::sqrt(std::min(1.0f, amplitude * gain)));
}

}  // namespace

void draw_waveform(Context& context, TimelineState& state, const editor::Waveforms& waveforms,
                   const edit::PerformerTrack& track, float top, float bottom) {
    if (track.sound.empty()) return;
    std::shared_ptr<const media::SoundPeaks> peaks = waveforms.of(track.sound);
    if (!peaks) return;
    const std::span<const float> amplitudes = amplitudes_of(state, track, std::move(peaks));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const unsigned colour = context.view.hears(track.name) ? kWave : kWaveMuted;
    const auto gain = static_cast<float>(std::pow(10, track.gain_db / 20));
    const float left = state.view.left(), centre = std::round((top + bottom) / 2), max = std::floor((bottom - top) / 2);
    float first = -1, last = -1;  // where anything is heard
    for (size_t i = 0, next = 0; i < amplitudes.size(); i = next) {
        const float height = height_of(amplitudes[i], gain, max);
        for (next = i + 1; next < amplitudes.size() && height_of(amplitudes[next], gain, max) == height;) ++next;
        if (height == 0) continue;
        const float from = left + static_cast<float>(i), to = left + static_cast<float>(next);
        list.AddRectFilled({from, centre - height}, {to, centre + height}, colour);
        if (first < 0) first = from;
        last = to;
    }
    if (first >= 0) context.report.area("timeline/" + track.name + "/waveform", first, top, last - first, bottom - top);
}

}  // namespace neuvv::viewer
