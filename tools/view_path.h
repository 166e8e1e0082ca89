// What a render shows, image by image: a camera and a time of the clip.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stage/camera_path.h"
#include "stage/stage.h"
#include "tools/options.h"
#include "voctree/files/world_frame.h"
#include "voctree/voctree.h"

namespace neuvv::tools {

struct ViewStep {
    stage::Camera camera;
    double frame = 0;  // of the clip
};

// The part of the clip that plays, and the rates of its frames and of the images that show it.
struct Playback {
    FrameRange range;
    double clip_fps = 25;
    double output_fps = 25;
};

// One turn around a box at a slight elevation, from +Z over +X, while the clip plays; the clip repeats until the turn
// has taken four seconds. The whole box is in every image. Throws InputError for more than a million images.
std::vector<ViewStep> orbit_path(const std::pair<glm::dvec3, glm::dvec3>& box, const Playback& playback,
                                 media::ImageSize size);
// The same around a clip's leaves, while all of the clip plays at its own rate.
std::vector<ViewStep> orbit_path(const voctree::VOctree& tree, media::ImageSize size);

// A camera whose principal point is the centre of its image.
stage::Camera centred_camera(media::ImageSize size, double focal_length_px, const glm::dmat4& world_from_camera);

// Along a camera path, image i at i / output_fps seconds: a cyclic path goes once around, an open one from its first
// key to its last. The clip is shown at the path's clip times, else it plays over and over. A path of one key without a
// clip time is a fixed camera, before which the clip plays once. A `size` of 0×0 stands for the path's own, or for
// `fallback` where the path has none; any size keeps the path's vertical angle of view. Throws InputError for more than
// a million images.
std::vector<ViewStep> path_steps(const stage::CameraPath& path, const Playback& playback, uint32_t clip_frames,
                                 media::ImageSize size, media::ImageSize fallback);

constexpr const char* kStagePath = "path";  // the --camera that is the stage's own camera path

// Whether the --camera of a stage is a camera path, a file that ends with .json, .usda, .glb or .gltf; else it is the
// name of one of the stage's cameras.
bool names_camera_path(const std::string& camera);

// How many images a path has at a rate; an open path shows both of its ends. A path of one key without a clip time is a
// fixed camera that shows `still_s` seconds. Throws InputError for more than a million images.
size_t path_images(const stage::CameraPath& path, double fps, double still_s);

// Nearest and farthest distance in metres of a box's bounding sphere from the cameras of a path, for images of depth.
std::pair<double, double> depth_range(const std::vector<ViewStep>& path, const std::pair<glm::dvec3, glm::dvec3>& box);

}  // namespace neuvv::tools
