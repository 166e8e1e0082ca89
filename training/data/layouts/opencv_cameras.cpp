// The names of keys are those of OpenCV's samples (calibration.cpp, stereo_calib.cpp), of ROS' camera_info and of
// programs like them. Poses are as cv::solvePnP and cv::stereoCalibrate give them: x_camera = R x_world + T, in the
// unit of the board.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <span>

#include "base/error.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/opencv_yaml.h"

namespace neuvv::training {

namespace {

constexpr const char* kMatrixKeys[] = {"camera_matrix", "cameraMatrix", "Camera_Matrix", "intrinsic_matrix", "K"};
constexpr const char* kDistortionKeys[] = {
    "distortion_coefficients", "Distortion_Coefficients", "distCoeffs", "dist_coeffs", "distortion", "D"};
constexpr const char* kRotationKeys[] = {"R", "rotation_matrix", "rotation", "rvec", "rotation_vector"};
constexpr const char* kTranslationKeys[] = {"T", "t", "translation", "tvec", "translation_vector"};
constexpr const char* kWidthKeys[] = {"image_width", "image_Width", "width"};
constexpr const char* kHeightKeys[] = {"image_height", "image_Height", "height"};

// The first of these keys that the file has; empty where it has none.
std::string key_of(const OpencvYaml& file, std::span<const char* const> keys) {
    for (const char* key : keys)
        if (file.has(key)) return key;
    return "";
}

std::string require_key(const OpencvYaml& file, std::span<const char* const> keys, const char* fix) {
    const std::string key = key_of(file, keys);
    if (key.empty()) throw InputError(file.file(), keys[0], "is missing", fix);
    return key;
}

uint32_t image_side(const OpencvYaml& file, std::span<const char* const> keys) {
    const std::string key = key_of(file, keys);
    if (key.empty()) return 0;
    const double side = file.number(key).value_or(0);
    if (!(side >= 1 && side <= media::kMaxImageSide && side == std::floor(side)))
        throw InputError(file.file(), key, fmt::format("is {}", side), "give the images' size in pixels");
    return static_cast<uint32_t>(side);
}

bool is_fisheye(const OpencvYaml& file) {
    if (file.has("fisheye_model")) return file.number("fisheye_model") != 0;
    if (!file.has("distortion_model")) return false;
    const std::string model = file.text("distortion_model");
    if (model == "equidistant" || model == "fisheye") return true;
    if (model != "plumb_bob" && model != "rational_polynomial")
        throw InputError(file.file(), "distortion_model", fmt::format("{:.40} is not modelled", model),
                         "calibrate as plumb_bob, rational_polynomial or equidistant");
    return false;
}

CalibratedCamera camera_in(const OpencvYaml& file, const std::string& name) {
    constexpr const char* kPoseFix = "write each camera's pose into its file, world to camera";
    const std::string matrix = require_key(file, kMatrixKeys, "give the camera matrix");
    const std::string rotation = require_key(file, kRotationKeys, kPoseFix);
    const std::string translation = require_key(file, kTranslationKeys, kPoseFix);
    std::vector<double> distortion;
    if (const std::string key = key_of(file, kDistortionKeys); !key.empty())
        distortion = file.matrix(key, {4, 5, 8, 12, 14}).value_or(distortion);
    CalibratedCamera result{{}, matrix};
    RigCamera& camera = result.camera;
    camera.name = name;
    camera.lens = opencv_lens(*file.matrix(matrix, {9}), distortion, is_fisheye(file), file.file(), matrix);
    camera.lens.width = image_side(file, kWidthKeys);
    camera.lens.height = image_side(file, kHeightKeys);
    const std::vector<double> t = *file.matrix(translation, {3});
    camera.world_from_camera =
        world_from_opencv(opencv_rotation(*file.matrix(rotation, {3, 9}), file.file(), rotation), {t[0], t[1], t[2]});
    expect_sound(camera, file.file(), matrix);
    return result;
}

// Files with a camera matrix, by the name of the camera: those of the first folder that has any. Other YAML files may
// lie beside them. `remark`: which other folder has such files, too.
using CameraFiles = std::map<std::string, std::filesystem::path, NaturalOrder>;
CameraFiles camera_files(const std::filesystem::path& folder, std::string* remark = nullptr) {
    CameraFiles chosen;
    for (const auto& candidate : calibration_folders(folder)) {
        CameraFiles files;
        for (const char* ending : {".yml", ".yaml"})
            for (const char* key : kMatrixKeys)
                for (const auto& file : find_files_by_header(candidate, ending, {fmt::format("\n{}:", key)})) {
                    const auto [found, fresh] = files.try_emplace(file.stem().string(), file);
                    if (!fresh && found->second != file)
                        throw InputError(file.string(), "", "is of the same camera as " + found->second.string(),
                                         "remove one of them");
                }
        if (files.empty()) continue;
        if (chosen.empty())
            chosen = files;
        else if (remark)
            *remark = choice_remark(chosen.begin()->second.lexically_relative(folder).string() + " and its like",
                                    {files.begin()->second.lexically_relative(folder).string() + " and its like"});
    }
    return chosen;
}

}  // namespace

bool has_opencv_files(const std::filesystem::path& folder) {
    return !camera_files(folder).empty();
}

Rig read_opencv_rig(const std::filesystem::path& folder, Split split) {
    std::string remark;
    const CameraFiles files = camera_files(folder, &remark);
    if (files.empty())
        throw InputError(folder.string(), "", "holds no YAML file with a camera_matrix",
                         "put the calibration of each camera into <camera>.yml");
    Rig rig;
    rig.folder = folder;
    rig.format = "opencv";
    rig.file = files.begin()->second.parent_path().string();
    if (!remark.empty()) rig.remarks.push_back(remark);
    rig.world = "the unit and the axes of the board that the cameras were calibrated by, not turned";
    std::vector<CalibratedCamera> cameras;
    for (const auto& [name, path] : files) {
        cameras.push_back(camera_in(OpencvYaml(path), name));
        cameras.back().place = path.filename().string();
    }
    add_cameras(rig, find_images(rig, cameras), split);
    return rig;
}

}  // namespace neuvv::training
