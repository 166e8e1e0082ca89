// Camera paths of instant-ngp.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/output_path.h"
#include "interchange/camera/camera_path_file.h"
#include "interchange/camera/camera_path_formats.h"
#include "interchange/camera/json_pose.h"

namespace neuvv::interchange {

namespace {

using ngp_json = nlohmann::ordered_json;

constexpr double kNgpDefault_s = 5;  // instant-ngp's duration, where the file gives none
constexpr double kFocusScale = 1.5;  // where instant-ngp focuses, for a lens that blurs; ours does not

// R is a unit quaternion (x, y, z, w) and T a position: both take camera coordinates with OpenCV axes (x right, y down,
// z forward) to instant-ngp's cube.
stage::CameraPathKey ngp_key(const JsonNode& node, const NgpCube& cube) {
    for (const char* name : {"R", "T", "fov"})
        if (!node.has(name)) node.fail(fmt::format("has no {}", name), "save the camera path with instant-ngp");
    expect_array(node["R"], 4);
    expect_array(node["T"], 3);
    double r[4];
    glm::dvec3 position;
    for (size_t i = 0; i < 4; ++i) r[i] = json_number(node["R"][i]);
    for (size_t i = 0; i < 3; ++i) position[static_cast<int>(i)] = json_number(node["T"][i]);
    const glm::dquat turn(r[3], r[0], r[1], r[2]);
    if (std::abs(glm::length(turn) - 1) > kUnitTolerance)
        node["R"].fail("is not a unit quaternion", "give x, y, z, w of a rotation");
    // Directions are transformed as positions are, but without scale and offset.
    const NgpCube turned{1, glm::dvec3(0)};
    const glm::dmat3 axes = glm::mat3_cast(glm::normalize(turn));
    glm::dmat4 pose(
        glm::dvec4(kYUpFromZUp * turned.to_world(axes[0]), 0), glm::dvec4(kYUpFromZUp * turned.to_world(-axes[1]), 0),
        glm::dvec4(kYUpFromZUp * turned.to_world(-axes[2]), 0), glm::dvec4(kYUpFromZUp * cube.to_world(position), 1));
    expect_rigid(node, pose);
    stage::CameraPathKey key;
    set_pose(key, pose);
    key.angle_y = path_degrees(node["fov"]);
    return key;
}

// The timestamps of keys. A key's timestamp is the time of the *next* key: the first key is at 0, and the timestamp of
// the last key is the end of a loop. Where timestamps do not ascend, instant-ngp spaces keys evenly.
std::vector<double> ngp_stamps(const JsonNode& keys) {
    const size_t count = keys.value.size();
    std::vector<double> stamps;
    bool ascend = true;
    for (size_t i = 0; i < count; ++i) {
        const JsonNode key = keys[i];
        const double stamp = key.has("timestamp") ? json_number(key["timestamp"]) : 0;
        ascend = ascend && stamp > (i ? stamps.back() : 0) && stamp <= kMaxPathSeconds;
        stamps.push_back(stamp);
    }
    if (!ascend)
        for (size_t i = 0; i < count; ++i) stamps[i] = static_cast<double>(i + 1) / static_cast<double>(count);
    return stamps;
}

// The inverse of ngp_key.
ngp_json ngp_json_of(const stage::CameraPathKey& key, const NgpCube& cube, double stamp) {
    const NgpCube turned{1, glm::dvec3(0)};
    const glm::dmat3 z_up_from_y_up = glm::transpose(kYUpFromZUp), axes = glm::mat3_cast(key.world_from_camera);
    const auto direction = [&](const glm::dvec3& d) { return turned.from_world(z_up_from_y_up * d); };
    const glm::dquat r = glm::quat_cast(glm::dmat3(direction(axes[0]), direction(-axes[1]), direction(-axes[2])));
    const glm::dvec3 t = cube.from_world(z_up_from_y_up * key.position);
    return {{"R", {r.x, r.y, r.z, r.w}},        {"T", {t.x, t.y, t.z}}, {"slice", 0.0},      {"scale", kFocusScale},
            {"fov", glm::degrees(key.angle_y)}, {"aperture_size", 0.0}, {"timestamp", stamp}};
}

}  // namespace

stage::CameraPath ngp_path(const JsonNode& root) {
    const JsonNode keys = root["path"];
    expect_list(keys);
    stage::CameraPath path;
    path.cyclic = root.has("loop") && json_flag(root["loop"]);
    const NgpCube cube = read_ngp_cube(root);
    const std::vector<double> stamps = ngp_stamps(keys);
    const size_t count = stamps.size();
    const double whole = path.cyclic ? stamps[count - 1] : count > 1 ? stamps[count - 2] : 1;
    path.duration_s = kNgpDefault_s;
    if (root.has("duration_seconds"))
        path.duration_s = json_number(root["duration_seconds"], 1e-3, kMaxPathSeconds, "a duration in seconds");
    if (root.has("spline_order")) {
        const double order = json_number(root["spline_order"], 0, 3, "the order of a spline");
        path.interpolation = order < 1   ? stage::Interpolation::kCut
                             : order < 2 ? stage::Interpolation::kLinear
                                         : stage::Interpolation::kSmooth;
    }
    for (size_t i = 0; i < count; ++i) {
        stage::CameraPathKey key = ngp_key(keys[i], cube);
        key.time_s = i == 0 ? 0 : stamps[i - 1] * (path.duration_s / whole);
        path.keys.push_back(key);
    }
    if (!path.cyclic) path.duration_s = path.keys.back().time_s;
    expect_path_times(path, keys);
    return path;
}

void write_ngp_path(const std::filesystem::path& file, const stage::CameraPath& images,
                    const std::filesystem::path& world) {
    ngp_json document = {{"loop", images.cyclic}, {"time", 0.0}, {"path", ngp_json::array()}};
    NgpCube cube;
    if (!world.empty()) {
        const JsonFile trained = read_json(world, "the transforms.json that instant-ngp was trained with");
        cube = read_ngp_cube(trained.root());
        document["scale"] = cube.scale;
        document["offset"] = {cube.offset.x, cube.offset.y, cube.offset.z};
    }
    const size_t count = images.keys.size();
    const double last_s = images.keys.back().time_s;
    for (size_t i = 0; i < count; ++i) {
        const double end_s = images.cyclic ? images.duration_s : last_s + 1 / images.fps;
        document["path"].push_back(
            ngp_json_of(images.keys[i], cube, i + 1 < count ? images.keys[i + 1].time_s : end_s));
    }
    document["duration_seconds"] = images.cyclic ? images.duration_s : std::max(last_s, 1 / images.fps);
    document["spline_order"] = 1;
    write_text_file(file, document.dump(1) + "\n");
}

}  // namespace neuvv::interchange
