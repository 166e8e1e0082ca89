#include "training/data/segments.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"

namespace neuvv::training {

std::vector<double> times_of(const Rig& rig) {
    std::set<double> times;
    for (const Shot& shot : rig.shots) times.insert(shot.time);
    return {times.begin(), times.end()};
}

std::optional<UnevenTime> uneven_time(const std::vector<double>& times, double most) {
    const auto frames = static_cast<uint32_t>(times.size());
    for (uint32_t frame = 0; frame < frames && frames > 1; ++frame)
        if (const double at = frame_of_time(times[frame], frames); std::abs(at - frame) > most)
            return UnevenTime{frame, times[frame], at};
    return {};
}

std::vector<uint32_t> segment_lengths(uint32_t frames, uint32_t longest) {
    const uint32_t segments = (frames + longest - 1) / longest;
    std::vector<uint32_t> lengths;
    for (uint32_t i = 0; i < segments; ++i)
        lengths.push_back(static_cast<uint32_t>(uint64_t{i + 1} * frames / segments - uint64_t{i} * frames / segments));
    return lengths;
}

Rig rig_of_frames(const Rig& rig, const std::vector<double>& times, uint32_t first, uint32_t count) {
    const double begin = times.at(first), end = times.at(first + count - 1);
    Rig part{rig.folder, rig.format, rig.file, rig.cameras, {}, rig.masks, rig.box, rig.frame};
    part.fps = rig.fps;
    for (const Shot& shot : rig.shots) {
        if (shot.time < begin || shot.time > end) continue;
        part.shots.push_back(shot);
        part.shots.back().time = end > begin ? (shot.time - begin) / (end - begin) : 0;
    }
    drop_cameras_without_shots(part);
    return part;
}

}  // namespace neuvv::training
