// A small analytic capture: a coloured sphere that moves along x, seen by a ring of cameras, as a Dataset or as the
// folder of a data set.
#pragma once

#include <fmt/format.h>

#include <array>
#include <numbers>

#include "support/look_at.h"
#include "support/temporary_folder.h"
#include "training/data/dataset.h"

namespace neuvv::test {

struct SphereCapture {
    uint32_t cameras = 12, frames = 3, size = 48;
    double radius_m = 0.4;
    double travel_m = 0.3;     // the centre moves from x = −travel_m to +travel_m over the clip
    double first_angle = 0.1;  // of the ring's first camera
    double distance_m = 3;

    glm::dvec3 centre(double time) const { return {travel_m * (2 * time - 1), 0.05, 0}; }
    double time(uint32_t frame) const { return frames > 1 ? static_cast<double>(frame) / (frames - 1.0) : 0.0; }
};

inline stage::Camera sphere_camera(const SphereCapture& capture, uint32_t index) {
    const double angle = capture.first_angle + 2 * std::numbers::pi * index / capture.cameras;
    const double height = std::array{0.4, 1.3, -0.6}[index % 3];
    const glm::dvec3 eye = capture.distance_m * glm::normalize(glm::dvec3(std::cos(angle), height, std::sin(angle)));
    return look_at(eye, {0, 0, 0}, capture.size, capture.size, 1.3);
}

// The linear colour of the sphere at a position of the image (pixels); alpha is 0 where the ray misses the sphere.
inline glm::dvec4 sphere_colour(const SphereCapture& capture, const stage::Camera& camera, double time, glm::dvec2 at) {
    const glm::dvec3 in_camera((at.x - camera.cx) / camera.fx, -(at.y - camera.cy) / camera.fy, -1);
    const glm::dvec3 ray = glm::normalize(glm::dmat3(camera.world_from_camera) * in_camera);
    const glm::dvec3 eye = glm::dvec3(camera.world_from_camera[3]) - capture.centre(time);
    const double along = -glm::dot(eye, ray);
    const double inside = capture.radius_m * capture.radius_m - glm::dot(eye, eye) + along * along;
    if (inside <= 0) return glm::dvec4(0);
    const glm::dvec3 normal = (eye + (along - std::sqrt(inside)) * ray) / capture.radius_m;
    return {0.5 + 0.35 * normal, 1};
}

// The image of a camera, with sixteen samples per pixel and straight alpha.
inline media::Image sphere_image(const SphereCapture& capture, const stage::Camera& camera, double time) {
    media::Image image(camera.width, camera.height);
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            glm::dvec4 sum(0);
            for (uint32_t i = 0; i < 16; ++i)
                sum += sphere_colour(capture, camera, time, {x + (i % 4 + 0.5) / 4, y + (i / 4 + 0.5) / 4});
            for (int c = 0; c < 3 && sum.a > 0; ++c)
                image.at(x, y)[c] = static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(sum[c] / sum.a)));
            image.at(x, y)[3] = static_cast<uint8_t>(std::lround(255 * sum.a / 16));
        }
    return image;
}

inline training::Dataset sphere_dataset(const SphereCapture& capture) {
    training::Dataset dataset;
    dataset.folder = "sphere";
    dataset.fps = 25;
    dataset.plates.resize(capture.cameras);
    for (uint32_t camera = 0; camera < capture.cameras; ++camera) {
        dataset.cameras.push_back(sphere_camera(capture, camera));
        for (uint32_t frame = 0; frame < capture.frames; ++frame)
            dataset.views.push_back(
                {fmt::format("c{:02}_f{:03}", camera, frame), camera, capture.time(frame),
                 training::TiledImage(sphere_image(capture, dataset.cameras.back(), capture.time(frame)))});
    }
    for (uint32_t frame = 0; frame < capture.frames; ++frame) dataset.times.push_back(capture.time(frame));
    return dataset;
}

// Writes a data set as a folder with a train split.
inline void write_capture(const std::filesystem::path& folder, const training::Dataset& dataset) {
    std::string frames;
    for (const training::View& view : dataset.views) {
        const stage::Camera& camera = dataset.cameras[view.camera];
        std::string rows;
        for (int row = 0; row < 4; ++row) {
            const glm::dmat4& m = camera.world_from_camera;
            rows += fmt::format("{}[{},{},{},{}]", row > 0 ? "," : "", m[0][row], m[1][row], m[2][row], m[3][row]);
        }
        frames += fmt::format(R"({}{{"file_path":"{}.png","time":{},"fl_x":{},"w":{},"h":{},"transform_matrix":[{}]}})",
                              frames.empty() ? "" : ",\n", view.name, view.time, camera.fx, camera.width, camera.height,
                              rows);
        media::write_png(folder / (view.name + ".png"), view.image.whole());
    }
    write_text(folder / "transforms_train.json", "{\"frames\":[" + frames + "]}");
}

}  // namespace neuvv::test
