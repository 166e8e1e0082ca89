// Checks the cameras of a capture against each other before it is trained.
#pragma once

#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"
#include "training/tree/misfits.h"

namespace neuvv::training {

// Reads the images of a few times and looks for misfits (misfits.h). Where two cameras have each other's images, these,
// masks and plates are exchanged; other misfits are left out. Rig::remarks say what was done. A rig without mattes, or
// with fewer than kMinJudgedCameras, is left as it is. Throws InputError as read_images() does.
void check_cameras(Rig& rig);

// Of the times of a clip, ascending, the few at which cameras are judged, evenly spread.
std::vector<double> look_times(const std::vector<double>& times);

// What is said of two cameras, by their names, that have each other's images, without a full stop.
std::string swap_text(const SwappedCameras& pair, const std::string& a, const std::string& b);

// From so many cameras on, views between them gain little by more: 4, 6, 8, 10, 12, 24
// cameras of the bundled performer gave 27.3, 28.8, 30.6, 33.1, 33.5, 34.4 dB.
constexpr size_t kEnoughCameras = 10;
// A time may lie so far between two frames. Images of times further away teach the frames on both sides, which blurs
// what moves; such times are found where somebody took frames out of a larger transforms.json.
constexpr double kMostBetweenFrames = 0.1;
// What to expect of a rig with fewer cameras, which leave matter beside the performer that no image denies, and of one
// whose times lie further between frames; a line each.
std::vector<std::string> advice_on(const Rig& rig);

}  // namespace neuvv::training
