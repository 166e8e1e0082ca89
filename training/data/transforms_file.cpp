#include "training/data/transforms_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/output_path.h"

namespace neuvv::training {

namespace {

nlohmann::json matrix_rows(const glm::dmat4& matrix) {
    nlohmann::json rows = nlohmann::json::array();
    for (int r = 0; r < 4; ++r) rows.push_back({matrix[0][r], matrix[1][r], matrix[2][r], matrix[3][r]});
    return rows;
}

nlohmann::json intrinsics_of(const stage::Camera& camera) {
    return {{"w", camera.width},
            {"h", camera.height},
            {"fl_x", camera.fx},
            {"fl_y", camera.fy},
            {"cx", camera.cx},
            {"cy", camera.cy},
            {"camera_angle_x", 2 * std::atan(0.5 * camera.width / camera.fx)}};
}

}  // namespace

void write_transforms_file(const std::filesystem::path& file, const WrittenTransforms& transforms) {
    std::vector<nlohmann::json> intrinsics, poses;
    for (const stage::Camera& camera : transforms.cameras) {
        intrinsics.push_back(intrinsics_of(camera));
        poses.push_back(matrix_rows(camera.world_from_camera));
    }
    const bool alike =
        std::ranges::all_of(intrinsics, [&](const nlohmann::json& other) { return other == intrinsics[0]; });
    nlohmann::json root = alike && !intrinsics.empty() ? intrinsics[0] : nlohmann::json::object();
    if (transforms.fps > 0) root["fps"] = transforms.fps;
    if (transforms.box) {
        const auto& [low, high] = *transforms.box;
        root["aabb"] = {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
    }
    if (!transforms.written_by.empty()) root["written_by"] = transforms.written_by;
    root["frames"] = nlohmann::json::array();
    for (const WrittenFrame& from : transforms.frames) {
        nlohmann::json frame = alike ? nlohmann::json::object() : intrinsics[from.camera];
        frame["file_path"] = from.image;
        if (from.time) frame["time"] = *from.time;
        frame["transform_matrix"] = poses[from.camera];
        if (!from.plate.empty()) frame["background_path"] = from.plate;
        if (!from.mask.empty()) frame["mask_path"] = from.mask;
        root["frames"].push_back(std::move(frame));
    }
    write_text_file(file, root.dump());
}

}  // namespace neuvv::training
