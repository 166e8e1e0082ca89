#include "training/easymocap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "base/error.h"
#include "training/calibration.h"
#include "training/camera_folders.h"
#include "training/image_reader.h"
#include "training/opencv_yaml.h"

namespace neuvv::training {

namespace {

constexpr double kRotationTolerance = 1e-2;  // some files have three decimals

glm::dmat3 rows_of(const std::vector<double>& m) {
    return glm::transpose(glm::dmat3(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]));
}

// Reads R_<camera> (Rodrigues' vector), which stays a rotation when it is rounded, else Rot_<camera>.
glm::dmat3 read_rotation(const OpencvYaml& file, const std::string& camera) {
    if (const auto axis_angle = file.matrix("R_" + camera, {3})) {
        const glm::dvec3 v((*axis_angle)[0], (*axis_angle)[1], (*axis_angle)[2]);
        const double angle = glm::length(v);
        if (!(angle < 1e3))
            throw InputError(file.file(), "R_" + camera, "is no rotation", "give its axis times its angle");
        return angle > 0 ? glm::mat3_cast(glm::angleAxis(angle, v / angle)) : glm::dmat3(1);
    }
    const auto matrix = file.matrix("Rot_" + camera, {9});
    if (!matrix)
        throw InputError(file.file(), "R_" + camera, "is missing, and Rot_ too", "calibrate the camera, or unlist it");
    const glm::dmat3 given = rows_of(*matrix);
    const glm::dmat3 rotation = glm::mat3_cast(glm::normalize(glm::quat_cast(given)));
    for (int i = 0; i < 3; ++i)
        if (!(glm::length(given[i] - rotation[i]) < kRotationTolerance))
            throw InputError(file.file(), "Rot_" + camera, "is no rotation", "give 3×3 numbers, world to camera");
    return rotation;
}

std::vector<double> require_matrix(const OpencvYaml& file, const std::string& key, size_t size) {
    const auto matrix = file.matrix(key, {size});
    if (!matrix) throw InputError(file.file(), key, "is missing", "calibrate the camera, or unlist it");
    return *matrix;
}

uint32_t read_side(const OpencvYaml& file, const std::string& key) {
    const double side = file.number(key).value_or(0);
    if (side == -1 || side == 0) return 0;  // in EasyMocap: not known
    if (!(side >= 1 && side <= 1e9 && side == std::floor(side)))
        throw InputError(file.file(), key, fmt::format("is {}", side), "give the images' size in pixels");
    return static_cast<uint32_t>(side);
}

Lens read_lens(const OpencvYaml& file, const std::string& camera) {
    const std::vector<double> k = require_matrix(file, "K_" + camera, 9);
    const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6; };
    if (!near(k[3], 0) || !near(k[6], 0) || !near(k[7], 0) || !near(k[8], 1))
        throw InputError(file.file(), "K_" + camera, "is no camera matrix", "give fx 0 cx, 0 fy cy, 0 0 1");
    if (std::abs(k[1]) > 1e-3 * std::abs(k[0]))
        throw InputError(file.file(), "K_" + camera, fmt::format("has a skew of {:.4g}", k[1]),
                         "calibrate without skew");
    Lens lens;
    lens.fx = k[0];
    lens.fy = k[4];
    lens.cx = k[2] + 0.5;  // in OpenCV, the centres of pixels are at whole numbers
    lens.cy = k[5] + 0.5;
    lens.width = read_side(file, "W_" + camera);
    lens.height = read_side(file, "H_" + camera);
    const std::string key = file.has("D_" + camera) ? "D_" + camera : "dist_" + camera;
    const auto d = file.matrix(key, {4, 5, 8});  // k1 k2 p1 p2 k3 k4 k5 k6
    if (!d || std::all_of(d->begin(), d->end(), [](double value) { return value == 0; })) return lens;
    lens.model = LensModel::kBrown;
    lens.k[0] = (*d)[0];
    lens.k[1] = (*d)[1];
    lens.p1 = (*d)[2];
    lens.p2 = (*d)[3];
    for (size_t i = 4; i < d->size(); ++i) lens.k[i - 2] = (*d)[i];
    return lens;
}

RigCamera read_camera(const OpencvYaml& intrinsics, const OpencvYaml& extrinsics, const std::string& name) {
    RigCamera camera;
    camera.name = name;
    camera.lens = read_lens(intrinsics, name);
    const std::vector<double> t = require_matrix(extrinsics, "T_" + name, 3);
    camera.world_from_camera = world_from_opencv(read_rotation(extrinsics, name), {t[0], t[1], t[2]});
    expect_sound(camera, intrinsics.file(), "K_" + name);
    return camera;
}

// Whether masks contain numbers of body parts (ZJU-MoCap's mask_cihp), or 0 and 1: such masks are nearly black, whereas
// a matte is white somewhere.
bool hold_labels(const std::filesystem::path& masks, const std::vector<CameraFrames>& cameras) {
    constexpr uint8_t kLargestLabel = 32;
    if (masks.filename() == "mask_cihp") return true;
    uint8_t brightest = 0;
    for (const CameraFrames& camera : cameras) {
        if (camera.masks.empty() || camera.masks.begin()->second.video_frame >= 0) return false;
        const media::Image mask = ImageReader().read(camera.masks.begin()->second);
        for (size_t i = 0; i < mask.rgba.size(); ++i)
            if (i % 4 != 3) brightest = std::max(brightest, mask.rgba[i]);
        if (brightest > kLargestLabel) return false;
    }
    return brightest > 0;
}

}  // namespace

bool has_easymocap_files(const std::filesystem::path& folder) {
    std::error_code ignored;
    return std::filesystem::exists(folder / "intri.yml", ignored) ||
           std::filesystem::exists(folder / "annots.npy", ignored);
}

Rig read_easymocap_rig(const std::filesystem::path& folder, Split split) {
    std::error_code ignored;
    if (!std::filesystem::exists(folder / "intri.yml", ignored) &&
        std::filesystem::exists(folder / "annots.npy", ignored))
        throw InputError((folder / "annots.npy").string(), "", "is a Python pickle, which could run any program",
                         "make intri.yml and extri.yml of it, as training/README.md shows");
    const OpencvYaml intrinsics(folder / "intri.yml"), extrinsics(folder / "extri.yml");
    Rig rig;
    rig.folder = folder;
    rig.format = "easymocap";
    rig.file = intrinsics.file();
    const std::filesystem::path masks = first_folder(folder, {"masks", "mask", "mask_cihp"});
    std::vector<CameraFrames> cameras;
    std::set<std::string> seen;
    for (const std::string& name : intrinsics.names("names")) {
        expect_inside(name, rig.file, "names");
        if (!seen.insert(name).second)
            throw InputError(rig.file, "names", fmt::format("names {} twice", name), "name each camera once");
        CameraFrames camera{read_camera(intrinsics, extrinsics, name), "K_" + name, cameras.size(), {}, {}};
        camera.frames = frames_of_camera(folder, name, rig.fps);
        if (camera.frames.empty()) continue;
        if (!masks.empty()) camera.masks = masks_of_camera(masks, name, camera.frames);
        cameras.push_back(std::move(camera));
    }
    if (cameras.empty())
        throw InputError(folder.string(), "", "holds no image of any camera that intri.yml names",
                         "put them into images/<camera>/");
    expect_common_frames(rig, cameras);
    if (hold_labels(masks, cameras)) rig.masks = MaskMeaning::kLabels;
    add_cameras(rig, cameras, split);
    return rig;
}

}  // namespace neuvv::training
