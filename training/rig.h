// A capture as its files describe it, whatever their layout: calibrated cameras, and where each image lies. No pixels
// yet: a loader fills this in, load_dataset reads what it names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "training/dataset.h"
#include "training/lens.h"

namespace neuvv::training {

// An image file, or one frame of a video.
struct ImageSource {
    std::filesystem::path path;  // empty: none
    int64_t video_frame = -1;    // −1: an image file
};

// What white (or opaque: an alpha channel wins over brightness) says in a mask.
enum class MaskMeaning : uint8_t {
    kMatte,   // the performer, its edge soft: becomes the image's alpha
    kLabels,  // likewise, where any value but 0 is the performer: numbers of body parts, or 0 and 1
    kUsable,  // the pixel may be looked at; black pixels teach nothing (nerfstudio's mask_path)
    kIgnore,  // the opposite (instant-ngp's dynamic_mask)
};

struct RigCamera {
    std::string name;  // as the files call it
    Lens lens;
    glm::dmat4 world_from_camera{1};  // OpenGL axes, rigid
    ImageSource plate;                // clean plate, from the same lens
};

struct Shot {
    uint32_t camera = 0;  // index into Rig::cameras
    double time = 0;      // [0,1] over the clip
    std::string name;     // distinct within the rig
    std::string place;    // where the files speak of it, for errors: "frames[12]"
    ImageSource image;
    ImageSource mask;
};

struct Rig {
    std::filesystem::path folder;
    std::string format;  // "nerf", "n3v", "colmap", "easymocap"
    std::string file;    // the calibration, for errors
    std::vector<RigCamera> cameras;
    std::vector<Shot> shots;  // of the wanted split alone
    MaskMeaning masks = MaskMeaning::kMatte;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // min, max in metres, where the files give one
    double fps = 0;                                        // 0 where the files give none
};

}  // namespace neuvv::training
