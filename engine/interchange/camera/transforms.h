// Reads a transforms.json of the NeRF family: all fields are checked, images are not read.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "interchange/camera/json_pose.h"
#include "interchange/camera/lens.h"

namespace neuvv::interchange {

// Intrinsics as the file gives them: a focal length is in pixels, or else an angle, along each axis by itself; what is
// given of one axis alone is that of both. Fields of a frame win over those at the top of the file.
struct Intrinsics {
    std::optional<double> fl_x, fl_y, cx, cy;
    std::optional<double> camera_angle_x;  // radians, the whole horizontal angle of view
    std::optional<double> camera_angle_y;  // the vertical one
    uint32_t width = 0, height = 0;        // 0: not given
    std::string camera_model;              // empty: not given
    LensModel lens_model = LensModel::kBrown;
    std::array<double, 6> k{};
    double p1 = 0, p2 = 0;
};

struct TransformsFrame {
    std::string place;            // where in the file, for errors: "frames[12]"
    std::string file_path;        // relative, inside the folder; empty: not given
    std::string background_path;  // likewise
    std::string mask_path;        // likewise
    std::optional<double> time;
    std::optional<double> seconds;    // time at which a camera path reaches this pose
    glm::dmat4 world_from_camera{1};  // OpenGL axes; the world has +Y up and the capture's units (read_transforms)
    Intrinsics intrinsics;
};

struct Transforms {
    std::vector<TransformsFrame> frames;  // at least one
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;
    double fps = 0;
    bool z_up = false;  // whether the file's world had +Z up, and was turned
    // Of a camera path alone:
    bool loop = false;
    std::optional<double> duration_s;
    std::string interpolation;  // empty: not given
    // nerfstudio's {train,test,val}_filenames by Split: the file_paths of each split, where they are given.
    std::array<std::optional<std::vector<std::string>>, 3> split_files;
};

// Some programs write worlds with +Z up: nerfstudio (its files have camera_model), instant-ngp (aabb_scale), and
// Blender's script for the NeRF and D-NeRF scenes (frames have a rotation). Poses and box of such files are turned to
// +Y up, (x, y, z) → (x, z, −y). applied_scale is divided out; applied_transform is not undone, as it only turns the
// world. Throws InputError with the file and the place in its JSON.
Transforms read_transforms(const std::filesystem::path& file);
Transforms transforms_of(const JsonFile& file);

// instant-ngp maps a position p of the data set into a cube: p ↦ cycle(p · scale + offset), where cycle takes (x, y, z)
// to (y, z, x). from_world() does it, to_world() is the inverse.
struct NgpCube {
    double scale = 0.33;
    glm::dvec3 offset{0.5};
    glm::dvec3 from_world(const glm::dvec3& p) const {
        const glm::dvec3 q = p * scale + offset;
        return {q.y, q.z, q.x};
    }
    glm::dvec3 to_world(const glm::dvec3& p) const { return (glm::dvec3(p.z, p.x, p.y) - offset) / scale; }
};
// The cube by the keys `scale` and `offset`, or instant-ngp's defaults where they are missing. Throws InputError.
NgpCube read_ngp_cube(const JsonNode& root);

constexpr double kMaxPathSeconds = 1e6;

// The lens of a frame whose image has this size in pixels.
Lens make_lens(const Intrinsics& in, uint32_t width, uint32_t height);

}  // namespace neuvv::interchange
