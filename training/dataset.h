// A calibrated multi-view video in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "stage/camera.h"

namespace neuvv::training {

// One image of one camera at one time.
struct View {
    std::string name;     // distinct within the data set ("c00_f003")
    uint32_t camera = 0;  // index into Dataset::cameras
    double time = 0;      // [0,1] over the clip
    media::Image image;   // straight alpha = the matte. See Dataset::plates for what RGB means
    // Pixels of which nothing is known, row-major (empty: none): masked out, or outside what the lens saw. They are
    // 0 0 0 0 in `image`, but that says nothing: no lesson, no carving, no measure.
    std::vector<bool> ignored = {};

    bool ignores(uint32_t x, uint32_t y) const { return !ignored.empty() && ignored[size_t{y} * image.width + x]; }
};

struct Dataset {
    std::shared_ptr<std::pmr::memory_resource> spool;  // what the views' pixels lie in (null: plain memory); goes last
    std::filesystem::path folder;
    std::vector<stage::Camera> cameras;  // distinct poses and intrinsics, in order of first use
    std::vector<View> views;
    // Clean plates by camera (empty image: none). Where a camera has one, its views' RGB is the captured image,
    // background included; elsewhere RGB is the foreground's own colour under straight alpha.
    std::vector<media::Image> plates;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // min, max in metres, where the files give one
    double fps = 0;                                        // 0 where the files give none
    std::vector<double> times;                             // distinct, ascending
};

enum class Split { kTrain, kTest, kVal };  // kVal: of the layouts that know it

struct LoadOptions {
    std::string format = "auto";  // one of format_names()
    bool mattes_needed = true;    // false: images without a matte are taken as they are
    uint64_t memory_bytes = 0;    // that images may take (0: image_budget()); more of them wait on disk
};

// Bytes that images may take where nothing else is said: a share of what is free, as the model wants room, too.
uint64_t image_budget();

// Recognises the folder's layout (training/README.md), and reads the cameras and images of a split. Throws
// InputError naming file, place and fix for anything missing, mistyped, non-finite, not a rigid pose, of zero size, or
// without a matte.
Dataset load_dataset(const std::filesystem::path& folder, Split split, const LoadOptions& options = {});

// The frame, 0..frames−1, of a time in [0,1]. Times are written with few digits: next to a whole frame is that frame,
// else every image would also speak for its neighbours in time.
double frame_of_time(double time, uint32_t frames);

// Premultiplied linear RGB and alpha of a view's pixel: the foreground alone, its captured background (plate) removed.
glm::vec4 foreground(const Dataset& dataset, const View& view, uint32_t x, uint32_t y);

}  // namespace neuvv::training
