#include "training/tree/camera_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "training/data/images.h"
#include "training/data/layouts/formats.h"
#include "training/data/segments.h"
#include "training/tree/misfits.h"

namespace neuvv::training {

namespace {

constexpr size_t kLookTimes = 5;

// The rig with its images of a few times alone, evenly spread, and of each camera that has none of these its first.
Rig look_of(const Rig& rig) {
    const std::vector<double> some = look_times(times_of(rig));
    Rig look = rig;
    std::erase_if(look.shots, [&](const Shot& shot) { return !std::ranges::binary_search(some, shot.time); });
    std::vector<bool> is_seen(rig.cameras.size());
    for (const Shot& shot : look.shots) is_seen[shot.camera] = true;
    for (const Shot& shot : rig.shots) {
        if (!is_seen[shot.camera]) look.shots.push_back(shot);
        is_seen[shot.camera] = true;
    }
    return look;
}

std::string percent(double share) {
    return fmt::format("{:.1f} %", 100 * share);
}

void swap_back(Rig& rig, const SwappedCameras& pair) {
    RigCamera &a = rig.cameras[pair.a], &b = rig.cameras[pair.b];
    for (Shot& shot : rig.shots)
        if (shot.camera == pair.a || shot.camera == pair.b) shot.camera = pair.a + pair.b - shot.camera;
    std::swap(a.plate, b.plate);
    rig.remarks.push_back(swap_text(pair, a.name, b.name) +
                          ". They are used swapped back, with their masks and plates: exchange the names of "
                          "their images or videos, masks and plates");
}

void leave_out(Rig& rig, const std::vector<Misfit>& misfits) {
    for (const Misfit& misfit : misfits) {
        std::erase_if(rig.shots, [&](const Shot& shot) { return shot.camera == misfit.camera; });
        rig.remarks.push_back(fmt::format(
            "camera {} is left out, as its mattes contradict the others: {} of its performer is where others see "
            "background, and {} of what they see of the performer is background in it. Correct its images, its mattes "
            "or "
            "its calibration",
            rig.cameras[misfit.camera].name, percent(misfit.fit.unexplained), percent(misfit.fit.denied)));
    }
    drop_cameras_without_shots(rig);
}

}  // namespace

std::vector<double> look_times(const std::vector<double>& times) {
    std::set<double> some;
    for (size_t i = 0; i < kLookTimes && !times.empty(); ++i)
        some.insert(times[(2 * i + 1) * times.size() / (2 * kLookTimes)]);
    return {some.begin(), some.end()};
}

std::string swap_text(const SwappedCameras& pair, const std::string& a, const std::string& b) {
    return fmt::format(
        "the images of cameras {0} and {1} seem to be swapped: camera {0} shows what {1} should see, and {1} what {0} "
        "should see (other cameras deny {2} of the performer in an image, {3} when they are swapped back)",
        a, b, percent(pair.unexplained), percent(pair.unexplained_swapped));
}

void check_cameras(Rig& rig) {
    if (most_misfits(rig.cameras.size()) == 0) return;
    const Dataset look = read_images(look_of(rig), {.mattes_needed = false});
    if (!has_mattes(look)) return;
    const Misfits found = find_misfits(look);
    for (const SwappedCameras& pair : found.swapped) swap_back(rig, pair);
    if (!found.others.empty()) leave_out(rig, found.others);
}

std::vector<std::string> advice_on(const Rig& rig) {
    std::vector<std::string> advice;
    const size_t cameras = rig.cameras.size();
    if (cameras < kEnoughCameras)
        advice.push_back(
            fmt::format("{} camera{} few: their hull is larger than the performer, and views between them are worse, "
                        "with 8 cameras by some 4 dB, with 4 by 7",
                        cameras, cameras == 1 ? " is" : "s are"));
    const std::vector<double> times = times_of(rig);
    if (const auto uneven = uneven_time(times, kMostBetweenFrames))
        advice.push_back(
            fmt::format("the images' {} times are not even: {:.4g} is that of frame {:.2f}, not {}, so that what moves "
                        "is blurred; give each frame f of n the time f / (n − 1)",
                        times.size(), uneven->time, uneven->at, uneven->frame));
    return advice;
}

}  // namespace neuvv::training
