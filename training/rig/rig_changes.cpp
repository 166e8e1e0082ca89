#include "training/rig/rig_changes.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/error.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

constexpr size_t kMostLeftOut = 4;  // one camera in so many

// The frame that a view shows; −1 beyond the clip.
int64_t frame_shown(const Dataset& dataset, const View& view, double frames_late) {
    const auto at = std::ranges::lower_bound(dataset.times, view.time) - dataset.times.begin();
    const int64_t frame = at + std::lround(frames_late);
    return frame < static_cast<int64_t>(dataset.times.size()) ? std::max<int64_t>(frame, -1) : -1;
}

}  // namespace

bool is_between_frames(double frames_late) {
    return std::abs(frames_late - std::round(frames_late)) > kMostOffFrame;
}

std::vector<bool> left_out(const RigChanges& changes) {
    std::vector<bool> out;
    for (const double late : changes.frames_late) out.push_back(is_between_frames(late));
    const auto are_too_many = [](const std::vector<bool>& some) {
        return static_cast<size_t>(std::ranges::count(some, true)) * kMostLeftOut > some.size();
    };
    if (are_too_many(out)) out.assign(out.size(), false);
    std::vector<bool> with_rolling = out;
    for (size_t i = 0; i < std::min(out.size(), changes.readout.size()); ++i)
        with_rolling[i] = with_rolling[i] || std::abs(changes.readout[i]) > kMostReadout;
    return are_too_many(with_rolling) ? out : with_rolling;
}

std::vector<RefinedPose> refined_poses(const RigChanges& changes, const Dataset& dataset) {
    if (changes.poses.empty()) return {};
    std::vector<RefinedPose> poses;
    const auto [low, high] = first_box(dataset);
    const glm::dvec3 centre = 0.5 * (low + high);
    for (size_t i = 0; i < changes.poses.size(); ++i) {
        const stage::Camera& given = dataset.cameras[i];
        poses.push_back({changes.poses[i], image_motion(given, changes.poses[i], centre),
                         is_at_bound(changes.poses[i], pose_bounds(given, centre))});
    }
    return poses;
}

void apply(const RigChanges& changes, Dataset& dataset) {
    dataset.cameras = moved(dataset.cameras, changes.poses);
    if (changes.frames_late.empty()) return;
    assert(changes.frames_late.size() == dataset.cameras.size() && "a number for each camera");
    const std::vector<bool> out = left_out(changes);
    // The frame of each view; −1: it is left out.
    std::vector<int64_t> frames;
    std::vector<bool> has_image(dataset.times.size());
    for (const View& view : dataset.views) {
        frames.push_back(out[view.camera] ? -1 : frame_shown(dataset, view, changes.frames_late[view.camera]));
        if (frames.back() >= 0) has_image[static_cast<size_t>(frames.back())] = true;
    }
    if (!std::ranges::all_of(has_image, [](bool has) { return has; }))
        throw InputError(dataset.folder.string(), "",
                         "has a frame of which no image is left without cameras that are late or roll",
                         Remedy::kKeepTimes);
    size_t view = 0;
    std::erase_if(dataset.views, [&](View& one) {
        const int64_t frame = frames[view++];
        if (frame >= 0) one.time = dataset.times[static_cast<size_t>(frame)];
        return frame < 0;
    });
}

}  // namespace neuvv::training
