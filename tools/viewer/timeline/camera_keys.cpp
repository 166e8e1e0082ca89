#include "tools/viewer/timeline/camera_keys.h"

#include <algorithm>
#include <cmath>

namespace neuvv::viewer {

stage::CameraPathKey key_of(const Eye& eye, double time_s) {
    const glm::dmat4 world_from_camera = world_from_eye(eye);
    stage::CameraPathKey key;
    key.time_s = time_s;
    key.position = glm::dvec3(world_from_camera[3]);
    key.world_from_camera = glm::normalize(glm::quat_cast(glm::dmat3(world_from_camera)));
    key.angle_y = eye.angle_y;
    return key;
}

Eye eye_on(const stage::CameraPath& path, double time_s, double distance_m) {
    const stage::Camera camera = stage::camera_at(path, time_s, 2, 2);
    return looking_through(camera.world_from_camera, 2 * std::atan(1 / camera.fy), distance_m);
}

size_t nearest_key(const stage::CameraPath& path, double time_s) {
    const auto is_nearer = [&](const stage::CameraPathKey& a, const stage::CameraPathKey& b) {
        return std::abs(a.time_s - time_s) < std::abs(b.time_s - time_s);
    };
    return static_cast<size_t>(std::min_element(path.keys.begin(), path.keys.end(), is_nearer) - path.keys.begin());
}

stage::CameraPath with_cyclic(stage::CameraPath path, bool cyclic) {
    const double first_s = path.keys.front().time_s, last_s = path.keys.back().time_s;
    const size_t segments = path.keys.size() - 1;
    const double mean_s = segments > 0 ? (last_s - first_s) / static_cast<double>(segments) : 1;
    path.cyclic = cyclic;
    if (!cyclic)
        path.duration_s = last_s;
    else if (path.duration_s <= last_s)
        path.duration_s = last_s + mean_s;
    return path;
}

std::vector<glm::dvec3> line_of(const stage::CameraPath& path, size_t steps) {
    std::vector<glm::dvec3> line;
    if (path.interpolation == stage::Interpolation::kCut) return line;
    steps = std::clamp<size_t>(steps, 1, std::max<size_t>(1, kMaxLinePoints / path.keys.size()));
    const auto add = [&](double from_s, double to_s) {
        for (size_t i = 0; i < steps; ++i) {
            const double t = from_s + (to_s - from_s) * static_cast<double>(i) / static_cast<double>(steps);
            line.emplace_back(stage::camera_at(path, t, 2, 2).world_from_camera[3]);
        }
    };
    for (size_t i = 0; i + 1 < path.keys.size(); ++i) add(path.keys[i].time_s, path.keys[i + 1].time_s);
    if (path.cyclic) add(path.keys.back().time_s, path.duration_s + path.keys.front().time_s);
    line.emplace_back((path.cyclic ? path.keys.front() : path.keys.back()).position);
    return line;
}

}  // namespace neuvv::viewer
