// Renders an animated glTF model from a dome of cameras into a data set that training reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "gpu/device.h"
#include "training/capture/dome.h"

namespace neuvv::stage {
struct GltfScene;
}

namespace neuvv::training {

enum class CaptureBackground {
    kClear,    // straight alpha; RGB is the performer's own colour
    kChecker,  // RGB is what a camera in a checkered room sees, alpha the matte; each camera has a clean plate
};

struct CaptureSettings {
    uint32_t cameras = 66;
    uint32_t frames = 75;
    double fps = 25;
    uint32_t width = 512, height = 512;
    std::string animation;  // name or index; empty: the first, or the rest pose where there is none
    double holdout = 0.1;   // share of the cameras that are held out for the test, below 1
    CaptureBackground background = CaptureBackground::kClear;
    // The seed of a simulated studio (studio.h), before the checkered room. Images that train become
    // images/cNN_fNNN.jpg with mattes/cNN_fNNN.png and plates/cNN.jpg; those held out are as with kChecker.
    std::optional<uint64_t> studio;
    // What recorders leave: a video of each camera, videos/cNN.mp4, in place of images, and no mattes. Only before the
    // checkered room.
    bool videos = false;
};

// Receives how many images are written, and of how many; returns false to stop.
using CaptureProgress = std::function<bool(uint64_t done, uint64_t total)>;

constexpr const char* kTrueSkeleton = "skeleton.glb";

struct CaptureResult {
    uint32_t train_cameras = 0, test_cameras = 0;
    uint64_t images = 0;
    std::string no_skeleton;         // why the model has no skeleton; empty: it has one
    std::vector<std::string> notes;  // what of the model is not shown, as in GltfScene::notes
    bool complete = false;           // false: stopped early, and the folder has no transforms
};

// Writes folder/images/cNN_fNNN.png, for a humanoid folder/skeleton.glb (motion/skeleton/skeleton_file.h), with a
// checkered background folder/plates/cNN.png, of a studio folder/studio.json, and last of all
// folder/transforms_train.json and _test.json, so that a folder with transforms is complete. Older transforms are
// removed first. Frame i shows the animation at i / fps seconds; an animation that has ended stays in its last pose.
// Throws InputError for settings and models that cannot be captured, RuntimeFailure for what the machine cannot do.
CaptureResult capture(const gpu::Device& device, const std::filesystem::path& model,
                      const std::filesystem::path& folder, const CaptureSettings& settings,
                      const CaptureProgress& progress);

// The cameras of a capture, each of which sees the whole motion.
struct CaptureStage {
    std::vector<DomeCamera> dome;
    std::vector<stage::Camera> cameras;
    std::pair<glm::dvec3, glm::dvec3> box;  // min, max of the motion in metres, slightly enlarged
    double radius = 0;                      // of the dome, metres
};
CaptureStage make_stage(const stage::GltfScene& scene, int32_t animation, const CaptureSettings& settings);

}  // namespace neuvv::training
