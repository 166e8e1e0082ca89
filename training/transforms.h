// A transforms.json of the NeRF family as it stands in the file: checked, but without its pictures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "training/dataset.h"

namespace neuvv {

// As given; a focal length is either in pixels or an angle. The frame's own fields win over the file's.
struct Intrinsics {
    std::optional<double> fl_x, fl_y, cx, cy;
    std::optional<double> camera_angle_x;  // radians, the whole horizontal angle of view
    uint32_t width = 0, height = 0;        // 0: not given
};

struct TransformsFrame {
    std::string place;            // "frames[12]"
    std::string file_path;        // relative, inside the folder; empty: not given
    std::string background_path;  // likewise
    std::optional<double> time;
    glm::dmat4 world_from_camera{1};
    Intrinsics intrinsics;
};

struct Transforms {
    std::vector<TransformsFrame> frames;  // at least one
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;
    double fps = 0;
};

// Throws InputError naming the file and the JSON place.
Transforms read_transforms(const std::filesystem::path& file);

// The camera of a frame whose picture has this size.
Camera make_camera(const TransformsFrame& frame, uint32_t width, uint32_t height);

}  // namespace neuvv
