// A simulated studio: what real cameras, and the people who run them, do to a capture. Everything follows from a seed
// and is the same on every machine, so that what went wrong is known.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "media/image.h"

namespace neuvv::training {

constexpr int kStudioJpegQuality = 85;
constexpr uint32_t kMinStudioCameras = 6;  // that train: two are swapped, two have wrong plates

enum class PlateFault { kNone, kOfAnotherCamera, kGreen, kMissing };

struct StudioCamera {
    bool held_out = false;                    // then nothing is done to it
    std::array<double, 3> gains = {1, 1, 1};  // of R, G, B in linear light, 0.7 to 1.4
    // Light at a distance r from the image's middle is multiplied by 1 + vignette[0] r² + vignette[1] r⁴; r is 1 in the
    // corners.
    std::array<double, 2> vignette = {0, 0};
    // The camera under whose name its images, mattes and plate lie: itself, unless two are swapped.
    size_t filed_as = 0;
    PlateFault plate_fault = PlateFault::kNone;
    size_t plate_of = 0;  // with kOfAnotherCamera: of which
};

enum class MatteFault { kLimbMissing, kHalfMissing, kTooMuch };

struct WrongMatte {
    size_t camera = 0;  // whose recording it is, wherever that is filed
    uint32_t frame = 0;
    MatteFault fault = MatteFault::kLimbMissing;
    uint32_t direction = 0;  // 0..7: where the part lies, by eighths of a turn
};

struct Studio {
    uint64_t seed = 0;
    std::vector<StudioCamera> cameras;
    std::vector<WrongMatte> wrong_mattes;  // 1 % of the images that train, at least one

    const WrongMatte* wrong_matte(size_t camera, uint32_t frame) const;  // null where the matte is right
};

// `held_out` by camera; at least kMinStudioCameras are not (assert).
Studio make_studio(uint64_t seed, const std::vector<bool>& held_out, uint32_t frames);

// What a camera records of a scene that it sees as `scene`, opaque: gains, vignetting, shot noise and read noise. Of
// equal arguments, the result is equal. A plate has the number kPlateFrame.
constexpr uint32_t kPlateFrame = UINT32_MAX;
media::Image record(const Studio& studio, size_t camera, uint32_t frame, const media::Image& scene);

// The scene's alpha as a grey image, with its fault where it has one.
media::Image studio_matte(const Studio& studio, size_t camera, uint32_t frame, const media::Image& scene);

// A plate that was taken of a green cloth.
media::Image green_plate(uint32_t width, uint32_t height);

constexpr const char* kStudioTruth = "studio.json";
// Writes all that was done as JSON. Throws RuntimeFailure.
void write_studio_truth(const std::filesystem::path& file, const Studio& studio);

}  // namespace neuvv::training
