// What a render shows, image by image: a camera and a time of the clip.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stage/camera_path.h"
#include "tools/options.h"
#include "voctree/voctree.h"

namespace neuvv::tools {

struct ViewStep {
    stage::Camera camera;
    double frame = 0;  // of the clip
};

// The part of the clip that plays, and how fast images follow each other.
struct Playback {
    FrameRange range;
    double clip_fps = 25;
    double output_fps = 25;
};

// The box around the tree's leaves in metres: minimum and maximum. The tree's own box where it has no leaf.
std::pair<glm::dvec3, glm::dvec3> occupied_box(const voctree::VOctree& tree);

// One turn around a box at a slight elevation, from +Z over +X, while the clip plays; it repeats until the turn has
// taken four seconds. The whole box is in every image. Throws InputError for too many images.
std::vector<ViewStep> orbit_path(const std::pair<glm::dvec3, glm::dvec3>& box, const Playback& playback,
                                 media::ImageSize size);
// The same around a clip's leaves, while all of the clip plays at its own rate.
std::vector<ViewStep> orbit_path(const voctree::VOctree& tree, media::ImageSize size);

// A camera whose principal point is the middle of its image.
stage::Camera centred_camera(media::ImageSize size, double focal_length_px, const glm::dmat4& world_from_camera);

// Along a camera path, image i at i / output_fps seconds: a cycle once around, an open path from its first key to its
// last, the performance at the path's clip times, else as the clip plays, over and over. One key without a clip time is
// a fixed camera: the clip plays once. `size` wins over the path's own (the vertical angle of view stays); 0×0: the
// path's, or `fallback` where it has none. Throws InputError for too many images.
std::vector<ViewStep> path_steps(const stage::CameraPath& path, const Playback& playback, uint32_t clip_frames,
                                 media::ImageSize size, media::ImageSize fallback);

// Whether what --camera says of a stage is the file of a camera path, told by its name (.json); else it names a camera
// of the stage.
bool names_camera_path(const std::string& camera);

// How many images a path has at a rate: both ends of an open one are shown. One key without a clip time is a camera
// that stands for `still_s`.
size_t path_images(const stage::CameraPath& path, double fps, double still_s);

// Nearest and farthest distance of a box's bounding sphere over a path, for images of depth.
std::pair<double, double> depth_range(const std::vector<ViewStep>& path, const std::pair<glm::dvec3, glm::dvec3>& box);

}  // namespace neuvv::tools
