// A figure with an arm, seen by a ring of cameras: mattes alone.
#pragma once

#include <algorithm>
#include <cmath>

#include "support/edit_image.h"
#include "support/sphere_capture.h"

namespace neuvv::test {

// A ball with an arm, a row of small balls, which turns over the clip.
constexpr float kBodyRadius = 0.35f, kArmRadius = 0.09f;
constexpr uint32_t kArmBalls = 8, kFigureFrames = 4;

inline glm::vec3 arm_ball(uint32_t frame, uint32_t i) {
    const float angle = 0.4f * static_cast<float>(frame), along = 0.4f + 0.06f * static_cast<float>(i);
    return along * glm::vec3(std::cos(angle), 0.5f, std::sin(angle));
}

inline bool meets(glm::vec3 eye, glm::vec3 ray, glm::vec3 centre, float radius) {
    const glm::vec3 across = glm::cross(centre - eye, ray);
    return glm::dot(across, across) < radius * radius * glm::dot(ray, ray);
}

inline bool sees_arm(glm::vec3 eye, glm::vec3 ray, uint32_t frame) {
    bool seen = false;
    for (uint32_t i = 0; i < kArmBalls; ++i) seen |= meets(eye, ray, arm_ball(frame, i), kArmRadius);
    return seen;
}

// Calls paint(pixel, sees the body, sees the arm) for each pixel of a view.
template <typename Paint>
void paint_view(training::Dataset& dataset, size_t index, const Paint& paint) {
    training::View& view = dataset.views[index];
    const stage::Camera& camera = dataset.cameras[view.camera];
    const glm::mat4 pose(camera.world_from_camera);
    const auto frame = static_cast<uint32_t>(std::lround(view.time * (kFigureFrames - 1)));
    edit_image(view, [&](media::Image& image) {
        for (uint32_t y = 0; y < camera.height; ++y)
            for (uint32_t x = 0; x < camera.width; ++x) {
                const glm::vec3 at((x + 0.5 - camera.cx) / camera.fx, -(y + 0.5 - camera.cy) / camera.fy, -1);
                const glm::vec3 eye(pose[3]), ray = glm::mat3(pose) * at;
                paint(image.at(x, y), meets(eye, ray, glm::vec3(0), kBodyRadius), sees_arm(eye, ray, frame));
            }
    });
}

inline void set_alpha(uint8_t* pixel, bool opaque) {
    std::fill_n(pixel, 4, uint8_t{0});
    if (opaque) std::fill_n(pixel, 4, uint8_t{255});
}

// `lowered`: by how many pixels the figure lies lower in all images than in their centre.
inline training::Dataset armed_figure(uint32_t cameras, double lowered = 0) {
    training::Dataset dataset = sphere_dataset({.cameras = cameras, .frames = kFigureFrames, .size = 64});
    for (stage::Camera& camera : dataset.cameras) camera.cy += lowered;
    for (size_t i = 0; i < dataset.views.size(); ++i)
        paint_view(dataset, i, [](uint8_t* pixel, bool body, bool arm) { set_alpha(pixel, body || arm); });
    return dataset;
}

// Each of these cameras sees what the figure, or a part of it, looks like from where it stands now.
inline void repaint(training::Dataset& dataset, uint32_t camera) {
    for (size_t i = 0; i < dataset.views.size(); ++i)
        if (dataset.views[i].camera == camera)
            paint_view(dataset, i, [](uint8_t* pixel, bool body, bool arm) { set_alpha(pixel, body || arm); });
}

inline void fill(training::Dataset& dataset, size_t view, bool opaque) {
    paint_view(dataset, view, [&](uint8_t* pixel, bool, bool) { set_alpha(pixel, opaque); });
}

inline void cut_arm(training::Dataset& dataset, size_t view) {
    paint_view(dataset, view, [](uint8_t* pixel, bool body, bool) { set_alpha(pixel, body); });
}

}  // namespace neuvv::test
