#include "tools/view_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/text.h"
#include "training/evaluation/evaluate.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::tools {

namespace {

constexpr double kMinTurnSeconds = 4;
constexpr double kElevation = 10 * std::numbers::pi / 180;
constexpr double kAngleOfView = 35 * std::numbers::pi / 180;  // of the image's shorter side
constexpr double kMargin = 1.08;  // of the distance, so that the box does not touch the image's border
constexpr double kMaxImages = 1e6;

// The frame of the clip at image i. The range plays over and over, each of its frames as long as any other. A .nvv
// keeps its rate as a float, so the output's rate is rounded to a float, too: otherwise images at 59.94 a second would
// drift off the frames of a clip of 29.97 a second.
double frame_at_image(const Playback& playback, double i) {
    const double span = playback.range.last - playback.range.first + 1;
    const double played = std::fmod(i * playback.clip_fps / double{static_cast<float>(playback.output_fps)}, span);
    return std::min(playback.range.first + played, playback.range.last);
}

size_t image_count(double fps, double seconds) {
    const double count = std::round(seconds * fps);
    if (!(count <= kMaxImages))
        throw InputError("--fps", fmt::format("{}", fps), fmt::format("makes more than {} images", kMaxImages),
                         "choose fewer --frames or a lower --fps");
    return std::max<size_t>(1, static_cast<size_t>(count));
}

double clip_seconds(const Playback& playback) {
    return (playback.range.last - playback.range.first + 1) / playback.clip_fps;
}

struct Axes {
    glm::dvec3 right, up, back;
};

Axes orbit_axes(double turn) {
    const double angle = 2 * std::numbers::pi * turn;
    const glm::dvec3 right(std::cos(angle), 0, -std::sin(angle));
    const glm::dvec3 back(std::sin(angle) * std::cos(kElevation), std::sin(kElevation),
                          std::cos(angle) * std::cos(kElevation));
    return {right, glm::cross(back, right), back};
}

// The smallest distance from the centre of an upright cylinder at which all of it is in the image. A point p, relative
// to the centre, is inside where |p·right| and |p·up| are at most (distance − p·back)·tan(half angle of view).
double fitting_distance(double radius, double half_height, double tan_x, double tan_y) {
    constexpr int kPoints = 64;
    const Axes axes = orbit_axes(0);
    double distance = 0;
    for (int i = 0; i < 2 * kPoints; ++i) {
        const double angle = 2 * std::numbers::pi * i / kPoints;
        const glm::dvec3 p(radius * std::cos(angle), i < kPoints ? half_height : -half_height,
                           radius * std::sin(angle));
        distance = std::max({distance, glm::dot(p, axes.back) + std::abs(glm::dot(p, axes.right)) / tan_x,
                             glm::dot(p, axes.back) + std::abs(glm::dot(p, axes.up)) / tan_y});
    }
    return distance;
}

}  // namespace

std::vector<ViewStep> orbit_path(const std::pair<glm::dvec3, glm::dvec3>& box, const Playback& playback,
                                 media::ImageSize size) {
    const double seconds = clip_seconds(playback);
    const size_t count =
        image_count(playback.output_fps, seconds * std::max(1.0, std::ceil(kMinTurnSeconds / seconds)));
    const glm::dvec3 centre = 0.5 * (box.first + box.second), half = 0.5 * (box.second - box.first);
    const double tan_short = std::tan(0.5 * kAngleOfView), shorter = std::min(size.width, size.height);
    const double distance =
        kMargin * fitting_distance(std::hypot(half.x, half.z), half.y, tan_short * size.width / shorter,
                                   tan_short * size.height / shorter);
    std::vector<ViewStep> path(count);
    for (size_t i = 0; i < count; ++i) {
        const Axes axes = orbit_axes(static_cast<double>(i) / static_cast<double>(count));
        const glm::dmat4 world_from_camera(glm::dvec4(axes.right, 0), glm::dvec4(axes.up, 0), glm::dvec4(axes.back, 0),
                                           glm::dvec4(centre + distance * axes.back, 1));
        path[i] = {centred_camera(size, 0.5 * shorter / tan_short, world_from_camera),
                   frame_at_image(playback, static_cast<double>(i))};
    }
    return path;
}

std::vector<ViewStep> orbit_path(const voctree::VOctree& tree, media::ImageSize size) {
    return orbit_path(voctree::occupied_box(tree), {{0, tree.frames - 1.0}, tree.fps, tree.fps}, size);
}

stage::Camera centred_camera(media::ImageSize size, double focal_length_px, const glm::dmat4& world_from_camera) {
    return {world_from_camera, focal_length_px, focal_length_px, 0.5 * size.width,
            0.5 * size.height, size.width,      size.height};
}

std::vector<ViewStep> path_steps(const stage::CameraPath& path, const Playback& playback, uint32_t clip_frames,
                                 media::ImageSize size, media::ImageSize fallback) {
    if (size.width == 0) size = {path.width, path.height};
    if (size.width == 0) size = fallback;
    std::vector<ViewStep> steps(path_images(path, playback.output_fps, clip_seconds(playback)));
    for (size_t i = 0; i < steps.size(); ++i) {
        const double time_s = static_cast<double>(i) / playback.output_fps;
        const std::optional<double> clip_time = stage::clip_time_at(path, time_s);
        steps[i].camera = stage::camera_at(path, time_s, size.width, size.height);
        steps[i].frame = clip_time ? training::frame_of_time(*clip_time, clip_frames)
                                   : frame_at_image(playback, static_cast<double>(i));
    }
    return steps;
}

bool names_camera_path(const std::string& camera) {
    const std::string ending = lower_case(std::filesystem::path(camera).extension().string());
    return ending == ".json" || ending == ".usda" || ending == ".glb" || ending == ".gltf";
}

size_t path_images(const stage::CameraPath& path, double fps, double still_s) {
    if (path.keys.size() == 1) return path.keys[0].clip_time ? 1 : image_count(fps, still_s);
    if (path.cyclic) return image_count(fps, path.duration_s);
    constexpr double kRounding = 1e-6;  // of an image: a last key at i / fps is image i
    return image_count(fps, (std::floor(path.duration_s * fps + kRounding) + 1) / fps);
}

std::pair<double, double> depth_range(const std::vector<ViewStep>& path, const std::pair<glm::dvec3, glm::dvec3>& box) {
    const glm::dvec3 centre = 0.5 * (box.first + box.second);
    const double radius = 0.5 * glm::distance(box.first, box.second);
    double near = std::numeric_limits<double>::infinity(), far = 0;
    for (const ViewStep& step : path) {
        const double distance = glm::distance(glm::dvec3(step.camera.world_from_camera[3]), centre);
        near = std::min(near, std::max(0.0, distance - radius));
        far = std::max(far, distance + radius);
    }
    return {near, far};
}

}  // namespace neuvv::tools
