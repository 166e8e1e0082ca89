// Data sets of the NeRF family: pictures beside a transforms.json. Fields: training/README.md.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "training/rig.h"

namespace neuvv {

bool has_nerf_files(const std::filesystem::path& folder);

// Reads `folder`/transforms_train.json or _test.json, or one transforms.json of which every 8th camera (the first, the
// 9th, …) is held out for the test split. Throws InputError naming file, JSON place and mend.
Rig read_nerf_rig(const std::filesystem::path& folder, Split split);

// Cameras of a path for `neuvv render --camera`: the frames of a transforms.json without its images, in file order,
// with `time` where given. A file without w and h leaves the size to the caller: width, height, cx and cy are then 0,
// and fx and fy are the focal length in picture widths (multiply by the width chosen; the principal point is the
// centre).
struct CameraKey {
    Camera camera;
    std::optional<double> time;
};
std::vector<CameraKey> load_camera_path(const std::filesystem::path& file);

}  // namespace neuvv
