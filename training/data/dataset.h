// A calibrated multi-view video in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/platform.h"
#include "stage/camera.h"
#include "training/data/layouts/rig/rig.h"
#include "training/data/tiled_image.h"
#include "voctree/files/world_frame.h"

namespace neuvv::training {

// One image of one camera at one time.
struct View {
    std::string name;     // unique in the data set ("c00_f003")
    uint32_t camera = 0;  // index into Dataset::cameras
    double time = 0;      // [0,1] over the clip
    TiledImage image;     // alpha, straight, is the matte; Dataset::plates says what RGB means
    // The pixels about which nothing is known, row by row (empty: none): masked out, or outside what the lens saw. They
    // are 0 0 0 0 in `image`, which means nothing: training, carving and measuring leave them out.
    std::vector<bool> ignored = {};

    bool ignores(uint32_t x, uint32_t y) const { return !ignored.empty() && ignored[size_t{y} * image.width() + x]; }
};

struct Dataset {
    // Where the views' pixels lie (null: plain memory). The first member, so that it is destroyed last.
    std::shared_ptr<SpooledMemory> spool;
    std::filesystem::path folder;
    std::string format = {};                     // its layout, as in Rig
    std::vector<stage::Camera> cameras;          // distinct poses and intrinsics, in order of first use
    std::vector<std::string> camera_names = {};  // as in the files; empty where there are none
    std::vector<View> views;
    // Clean plates by camera (an empty image: none). Where a camera has one, RGB of its views is the captured image,
    // background included; elsewhere RGB is the foreground's own colour under straight alpha.
    std::vector<media::Image> plates;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // min, max in metres, where the files give one
    double fps = 0;                                        // 0 where the files give none
    std::vector<double> times;                             // distinct, ascending
    // The frame of the capture's coordinates in which cameras and box are, and in which a clip is trained.
    voctree::WorldFrame frame{};
    std::vector<std::string> remarks = {};  // what the loader of the layout decided by itself
};

struct LoadOptions {
    std::string format = "auto";  // one of format_names()
    std::string holdout = {};     // which cameras are held out (layouts/rig/holdout.h); empty: as the layout has it
    bool mattes_needed = true;    // false: images without a matte are taken as they are
    bool may_be_empty = false;    // whether it is right that no image shows anything, as before the performer enters
    uint64_t memory_bytes = 0;    // memory that images may take (0: image_budget()); those beyond it lie on disk
};

// Moves the data set's cameras and box into the frame in which a clip was trained.
void change_frame(Dataset& dataset, const voctree::WorldFrame& frame);

// Whether an image has a pixel that is neither ignored nor wholly the performer.
bool has_mattes(const Dataset& dataset);

// The default of LoadOptions::memory_bytes: half of the free memory, as the model needs memory, too.
uint64_t image_budget();

// Recognises the folder's layout (training/data/layouts/README.md) and reads the cameras and images of a split. Throws
// InputError with file, place and fix for anything that is missing, of the wrong type, not finite, not a rigid pose, of
// zero size, or without a matte.
Dataset load_dataset(const std::filesystem::path& folder, Split split, const LoadOptions& options = {});

// The frame, 0..frames−1, of a time in [0,1], possibly between two frames. A time very near a whole frame gives that
// frame: files write times with few digits, and an image should not also train the frames beside its own.
double frame_of_time(double time, uint32_t frames);

// What the images of all views take, in memory and on disk.
uint64_t image_bytes(const Dataset& dataset);

// Premultiplied linear RGB and alpha of the foreground at a pixel of a view. A captured background (the plate) is
// removed.
glm::vec4 foreground(const Dataset& dataset, const View& view, uint32_t x, uint32_t y);

// The data set's image of a view over a background (media::composite_over). Where the camera has a clean plate, the
// captured background is removed.
media::Image truth_over(const Dataset& dataset, const View& view, const uint8_t background[3] = media::kWhite);

}  // namespace neuvv::training
