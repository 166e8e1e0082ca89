// The projection of a point by a camera of a rig, and small images for the files of rigs.
#pragma once

#include <filesystem>

#include "media/image.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::test {

inline glm::dvec2 pixel_of(const training::RigCamera& camera, glm::dvec3 world) {
    const glm::dvec3 p(glm::inverse(camera.world_from_camera) * glm::dvec4(world, 1));
    return interchange::project(camera.lens, {p.x / -p.z, -p.y / -p.z});
}

inline void write_grey_png(const std::filesystem::path& path, uint32_t width, uint32_t height, uint8_t grey = 128) {
    std::filesystem::create_directories(path.parent_path());
    media::Image image(width, height);
    for (size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = i % 4 == 3 ? 255 : grey;
    media::write_png(path, image);
}

}  // namespace neuvv::test
