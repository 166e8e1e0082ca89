// A transforms.json of the NeRF family as it stands in the file: checked, but without its images.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "training/dataset.h"
#include "training/json_pose.h"
#include "training/lens.h"

namespace neuvv::training {

// As given; a focal length is either in pixels or an angle. The frame's own fields win over the file's.
struct Intrinsics {
    std::optional<double> fl_x, fl_y, cx, cy;
    std::optional<double> camera_angle_x;  // radians, the whole horizontal angle of view
    std::optional<double> camera_angle_y;  // the vertical one, where the horizontal one is not given
    uint32_t width = 0, height = 0;        // 0: not given
    std::string camera_model;              // empty: not given
    LensModel lens_model = LensModel::kBrown;
    std::array<double, 6> k{};
    double p1 = 0, p2 = 0;
};

struct TransformsFrame {
    std::string place;            // "frames[12]"
    std::string file_path;        // relative, inside the folder; empty: not given
    std::string background_path;  // likewise
    std::string mask_path;        // likewise
    std::optional<double> time;
    std::optional<double> seconds;    // when a camera path is here
    glm::dmat4 world_from_camera{1};  // +Y up, in the units of the capture: see read_transforms
    Intrinsics intrinsics;
};

struct Transforms {
    std::vector<TransformsFrame> frames;  // at least one
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;
    double fps = 0;
    bool loop = false;  // of a camera path, as the two below
    std::optional<double> duration_s;
    std::string interpolation;  // empty: not given
    // nerfstudio's {train,test,val}_filenames: the file_paths of each split, by Split; all absent: not given.
    std::array<std::optional<std::vector<std::string>>, 3> split_files;
};

// Poses and box are turned from +Z up to +Y up, (x, y, z) → (x, z, −y), where the file is of a program that writes +Z
// up: nerfstudio (it has camera_model), instant-ngp (aabb_scale) or Blender's script for the NeRF and D-NeRF scenes
// (frames have a rotation). applied_scale is divided out; applied_transform stays, it only turns the world. Throws
// InputError naming the file and the JSON place.
Transforms read_transforms(const std::filesystem::path& file);
Transforms transforms_of(const JsonFile& file);

// instant-ngp's world is a cube: p ↦ cycle(p · scale + offset), (x, y, z) ↦ (y, z, x), where p is as in the data set.
struct NgpCube {
    double scale = 0.33;
    glm::dvec3 offset{0.5};
    glm::dvec3 to_world(const glm::dvec3& p) const { return (glm::dvec3(p.z, p.x, p.y) - offset) / scale; }
};
// By the keys `scale` and `offset`, its defaults where they are missing.
NgpCube read_ngp_cube(const JsonNode& root);

constexpr double kMaxPathSeconds = 1e6;

// The lens of a frame whose image has this size.
Lens make_lens(const Intrinsics& in, uint32_t width, uint32_t height);

}  // namespace neuvv::training
