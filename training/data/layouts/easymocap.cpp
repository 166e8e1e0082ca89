#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/layouts/rig/opencv_yaml.h"

namespace neuvv::training {

namespace {

// Reads R_<camera> (Rodrigues' vector), which stays a rotation when it is rounded, else Rot_<camera>.
glm::dmat3 read_rotation(const OpencvYaml& file, const std::string& camera) {
    if (const auto axis_angle = file.matrix("R_" + camera, {3}))
        return opencv_rotation(*axis_angle, file.file(), "R_" + camera);
    const auto matrix = file.matrix("Rot_" + camera, {9});
    if (!matrix)
        throw InputError(file.file(), "R_" + camera, "is missing, and Rot_ too", "calibrate the camera, or unlist it");
    return opencv_rotation(*matrix, file.file(), "Rot_" + camera);
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

interchange::Lens read_lens(const OpencvYaml& file, const std::string& camera) {
    const std::string key = file.has("D_" + camera) ? "D_" + camera : "dist_" + camera;
    const auto distortion = file.matrix(key, {4, 5, 8});
    interchange::Lens lens = opencv_lens(require_matrix(file, "K_" + camera, 9),
                                         distortion.value_or(std::vector<double>()), false, file.file(), "K_" + camera);
    lens.width = read_side(file, "W_" + camera);
    lens.height = read_side(file, "H_" + camera);
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

// The folders that have a calibration, the one that counts first: EasyVolcap writes into optimized/ what it has made of
// the one beside the images.
std::vector<std::filesystem::path> calibrations_in(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> found;
    std::error_code ignored;
    for (const auto& inside : {folder / "optimized", folder})
        if (std::filesystem::exists(inside / "intri.yml", ignored)) found.push_back(inside);
    return found;
}

// Adds remarks for calibrations beside the one that is read, of which EasyMocap writes several.
void note_other_calibrations(Rig& rig) {
    const std::filesystem::path read = std::filesystem::path(rig.file).parent_path();
    const auto name_in = [&](const std::filesystem::path& file) {
        return file.lexically_relative(rig.folder).string();
    };
    for (const std::string stem : {"intri", "extri"}) {
        std::vector<std::string> others;
        for (const auto& folder : calibrations_in(rig.folder))
            for (const auto& entry : entries_of(folder)) {
                const std::string name = entry.filename().string(), ending = entry.extension().string();
                if (name.starts_with(stem) && entry != read / (stem + ".yml") &&
                    (ending == ".yml" || ending == ".yaml"))
                    others.push_back(name_in(entry));
            }
        if (!others.empty()) rig.remarks.push_back(choice_remark(name_in(read / (stem + ".yml")), others));
    }
}

}  // namespace

bool has_easymocap_files(const std::filesystem::path& folder) {
    std::error_code ignored;
    return !calibrations_in(folder).empty() || std::filesystem::exists(folder / "annots.npy", ignored);
}

Rig read_easymocap_rig(const std::filesystem::path& folder, Split split) {
    std::error_code ignored;
    const std::vector<std::filesystem::path> calibrations = calibrations_in(folder);
    if (calibrations.empty() && std::filesystem::exists(folder / "annots.npy", ignored))
        throw InputError((folder / "annots.npy").string(), "", "is a Python pickle, which could run any program",
                         "make intri.yml and extri.yml of it by training/data/layouts/zju_mocap.py");
    const std::filesystem::path from = calibrations.empty() ? folder : calibrations[0];
    const OpencvYaml intrinsics(from / "intri.yml"), extrinsics(from / "extri.yml");
    Rig rig;
    rig.folder = folder;
    rig.format = "easymocap";
    rig.file = intrinsics.file();
    rig.world = "metres where the calibration is in metres; axes as calibrated, not turned";
    std::vector<CalibratedCamera> calibrated;
    std::set<std::string> seen;
    for (const std::string& name : intrinsics.names("names")) {
        expect_inside(name, rig.file, "names");
        if (!seen.insert(name).second)
            throw InputError(rig.file, "names", fmt::format("names {} twice", name), "name each camera once");
        calibrated.push_back({read_camera(intrinsics, extrinsics, name), "K_" + name});
    }
    const std::vector<CameraFrames> cameras = find_images(rig, calibrated);
    note_other_calibrations(rig);
    if (hold_labels(masks_folder(folder), cameras)) rig.masks = MaskMeaning::kLabels;
    add_cameras(rig, cameras, split);
    return rig;
}

}  // namespace neuvv::training
