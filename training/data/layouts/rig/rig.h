// A capture as its files describe it, whatever their layout: calibrated cameras, and where each image lies. A loader
// fills in a Rig without reading pixels; load_dataset reads the images that the Rig names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "interchange/camera/lens.h"
#include "voctree/files/world_frame.h"

namespace neuvv::training {

// Only some layouts have kVal. kAll is what loaders read where the user holds out cameras (holdout.h): training and
// test.
enum class Split { kTrain, kTest, kVal, kAll };

// An image file, or one frame of a video.
struct ImageSource {
    std::filesystem::path path;  // empty: none
    int64_t video_frame = -1;    // −1: an image file
    bool as_stored = false;      // whether an image file's Exif does not turn it
};

// What white means in a mask. Where a mask has an alpha channel, opaque counts as white.
enum class MaskMeaning : uint8_t {
    kMatte,   // the performer, with soft edges: the mask becomes the image's alpha
    kLabels,  // the same, but any value other than 0 is the performer: numbers of body parts, or 0 and 1
    kUsable,  // the pixel may be used; black pixels are ignored (nerfstudio's mask_path)
    kIgnore,  // the pixel is ignored (instant-ngp's dynamic_mask)
};

struct RigCamera {
    std::string name;  // as in the files
    interchange::Lens lens;
    glm::dmat4 world_from_camera{1};  // OpenGL axes, rigid
    ImageSource plate;                // clean plate, taken with the same lens
};

// One image of one camera at one time.
struct Shot {
    uint32_t camera = 0;  // index into Rig::cameras
    double time = 0;      // [0,1] over the clip
    std::string name;     // unique in the rig
    std::string place;    // where in the files it stands, for errors: "frames[12]"
    ImageSource image;
    ImageSource mask;
};

struct Rig {
    std::filesystem::path folder;
    std::string format;  // its name in formats.cpp
    std::string file;    // the file of the calibration, for errors
    std::vector<RigCamera> cameras;
    std::vector<Shot> shots;  // those of one split
    MaskMeaning masks = MaskMeaning::kMatte;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // min, max in metres, where the files give one
    // Cameras and box are in this frame of the capture's coordinates; loaders leave it as it is (world_of_rig.h).
    voctree::WorldFrame frame{};
    std::vector<glm::dmat4> poses = {};  // those of the cameras of all splits, as the files have them
    double fps = 0;                      // 0 where the files give none
    // What a person checks before training: the unit of the poses and the way up, and what else the loader decided.
    std::string world;
    std::vector<std::string> remarks;
    // Why the images of a camera, whatever its split, cannot be read with its lens: they have another shape than those
    // that it was calibrated for. Points in the images of the calibration can.
    std::optional<InputError> misfit = {};
    // Whether the program that calibrated ignores Exif's orientation. Loaders set it before they look for images.
    bool images_as_stored = false;
};

}  // namespace neuvv::training
