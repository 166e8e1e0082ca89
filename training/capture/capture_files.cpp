#include "training/capture/capture_files.h"

#include <fmt/format.h>

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

}  // namespace

std::string camera_name(size_t camera) {
    return fmt::format("c{:02}", camera);
}
std::string image_name(size_t camera, size_t frame) {
    return fmt::format("c{:02}_f{:03}", camera, frame);
}

void write_transforms(const std::filesystem::path& file, const CapturedClip& clip) {
    const stage::Camera& first = clip.cameras.front();
    const glm::dvec3 low = clip.box.first, high = clip.box.second;
    nlohmann::json root = {{"w", first.width},
                           {"h", first.height},
                           {"fl_x", first.fx},
                           {"fl_y", first.fy},
                           {"cx", first.cx},
                           {"cy", first.cy},
                           {"camera_angle_x", 2 * std::atan(0.5 * first.width / first.fx)},
                           {"fps", clip.fps},
                           {"aabb", {{low.x, low.y, low.z}, {high.x, high.y, high.z}}},
                           {"frames", nlohmann::json::array()}};
    for (size_t c = 0; c < clip.cameras.size(); ++c) {
        if (!clip.written[c]) continue;
        const nlohmann::json pose = matrix_rows(clip.cameras[c].world_from_camera);
        for (uint32_t f = 0; f < clip.frames; ++f) {
            nlohmann::json frame = {{"file_path", fmt::format("images/{}.png", image_name(c, f))},
                                    {"time", clip.frames > 1 ? f / (clip.frames - 1.0) : 0.0},
                                    {"transform_matrix", pose}};
            if (clip.plates) frame["background_path"] = fmt::format("plates/{}.png", camera_name(c));
            root["frames"].push_back(std::move(frame));
        }
    }
    write_text_file(file, root.dump());
}

}  // namespace neuvv::training
