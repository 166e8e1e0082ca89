// A calibrated multi-view video in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "stage/camera.h"

namespace neuvv {

// One picture of one camera at one instant.
struct View {
    std::string name;     // `file_path`'s file name without extension ("c00_f003")
    uint32_t camera = 0;  // index into Dataset::cameras
    double time = 0;      // [0,1] over the clip
    Image image;          // straight alpha = the matte. See Dataset::plates for what RGB means
};

struct Dataset {
    std::filesystem::path folder;
    std::vector<Camera> cameras;  // distinct poses and intrinsics, in order of first use
    std::vector<View> views;
    // Clean plates by camera (empty image: none). Where a camera has one, its views' RGB is the captured picture,
    // background included; elsewhere RGB is the foreground's own colour under straight alpha.
    std::vector<Image> plates;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // `aabb`: min, max in metres, where the file gives one
    double fps = 0;                                        // `fps`, 0 where the file gives none
    std::vector<double> times;                             // distinct, ascending
};

enum class Split { kTrain, kTest };

// Reads `folder`/transforms_train.json or _test.json, or one transforms.json of which every 8th camera (the first, the
// 9th, …) is held out for the test split. Fields: those of the NeRF family, see training/README.md. Throws InputError
// naming file, JSON place and mend for anything missing, mistyped, non-finite, not a rigid pose, of zero size, or
// without alpha.
Dataset load_dataset(const std::filesystem::path& folder, Split split);

// Cameras of a path for `neuvv render --camera`: the frames of a transforms.json without its images, in file order,
// with `time` where given. A file without w and h leaves the size to the caller: width, height, cx and cy are then 0,
// and fx and fy are the focal length in picture widths (multiply by the width chosen; the principal point is the
// centre).
struct CameraKey {
    Camera camera;
    std::optional<double> time;
};
std::vector<CameraKey> load_camera_path(const std::filesystem::path& file);

// The frame, 0..frames−1, of a time in [0,1]. Times are written with few digits: next to a whole frame is that frame,
// else every picture would also speak for its neighbours in time.
double frame_of_time(double time, uint32_t frames);

// Premultiplied linear RGB and alpha of a view's pixel: the foreground alone, its captured background (plate) removed.
glm::vec4 foreground(const Dataset& dataset, const View& view, uint32_t x, uint32_t y);

}  // namespace neuvv
