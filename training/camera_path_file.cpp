#include "training/camera_path_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>
#include <numbers>

#include "base/error.h"
#include "base/platform.h"
#include "media/image.h"
#include "stage/camera_path_json.h"
#include "training/transforms.h"

namespace neuvv::training {

namespace {

using json = nlohmann::json;

constexpr double kNgpDefault_s = 5;      // instant-ngp's duration, where the file gives none
constexpr double kUnitTolerance = 1e-2;  // of a quaternion's length
constexpr double kMinAngle_deg = 0.1, kMaxAngle_deg = 179;
constexpr double kMinFps = 0.01, kMaxFps = 1e4;

void set_pose(stage::CameraPathKey& key, const glm::dmat4& world_from_camera) {
    key.position = glm::dvec3(world_from_camera[3]);
    key.world_from_camera = glm::normalize(glm::quat_cast(glm::dmat3(world_from_camera)));
}

double degrees(const JsonNode& node) {
    return json_number(node, kMinAngle_deg, kMaxAngle_deg, "an angle of view in degrees") * std::numbers::pi / 180;
}

// Checks what CameraPath promises about the times of its keys.
void expect_path_times(const stage::CameraPath& path, const JsonNode& keys) {
    for (size_t i = 1; i < path.keys.size(); ++i)
        if (!(path.keys[i].time_s > path.keys[i - 1].time_s))
            keys[i].fail(fmt::format("is at {} s, not after the key before it", path.keys[i].time_s),
                         "give times that ascend");
    const double last = path.keys.back().time_s;
    const bool long_enough = path.cyclic ? path.duration_s > last : path.duration_s >= last;
    if (path.keys.size() > 1 && !long_enough)
        keys[path.keys.size() - 1].fail(
            fmt::format("is at {} s of a path of {} s", last, path.duration_s),
            path.cyclic ? "give a loop time to come back to its first key" : "give the whole duration");
}

// One frame of a transforms.json as a key, without its time.
stage::CameraPathKey key_of(const TransformsFrame& frame, const std::string& file) {
    const Intrinsics& in = frame.intrinsics;
    const bool sized = in.width != 0;
    if (!sized && (in.fl_x || in.fl_y || in.cx || in.cy))
        throw InputError(file, frame.place, "fl_x, fl_y, cx, cy are in pixels of an image of unknown size",
                         "give w and h, or camera_angle_x or camera_angle_y alone");
    const Lens lens = make_lens(in, in.width, in.height);
    if (lens.distorts())
        throw InputError(file, frame.place, "has a lens that distorts: images are rendered by pinholes",
                         "remove camera_model, is_fisheye and k1 to p2");
    stage::CameraPathKey key;
    set_pose(key, frame.world_from_camera);
    key.clip_time = frame.time;
    if (sized) {
        const double height = lens.height;
        key.angle_y = 2 * std::atan(0.5 * height / lens.fy);
        key.stretch = lens.fx / lens.fy;
        key.shift = {(lens.cx - 0.5 * lens.width) / height, (lens.cy - 0.5 * height) / height};
    } else if (in.camera_angle_x) {
        key.angle_x = in.camera_angle_x;
    } else {
        key.angle_y = in.camera_angle_y.value();
    }
    return key;
}

stage::Interpolation interpolation_of(const JsonNode& node) {
    const std::string& name = json_string(node);
    for (size_t i = 0; i < std::size(stage::kInterpolationNames); ++i)
        if (name == stage::kInterpolationNames[i]) return static_cast<stage::Interpolation>(i);
    node.fail("is no interpolation", "write smooth, linear or cut");
}

stage::CameraPath transforms_path(const JsonFile& file, double views_per_s) {
    const JsonNode root = file.root();
    const Transforms transforms = transforms_of(file);
    const bool timed = transforms.frames[0].seconds.has_value();
    stage::CameraPath path;
    path.interpolation = stage::Interpolation::kCut;
    if (timed)
        path.interpolation =
            transforms.interpolation.empty() ? stage::Interpolation::kSmooth : interpolation_of(root["interpolation"]);
    path.cyclic = timed && transforms.loop;
    path.width = transforms.frames[0].intrinsics.width;
    path.height = transforms.frames[0].intrinsics.height;
    for (const TransformsFrame& frame : transforms.frames) {
        if (frame.seconds.has_value() != timed)
            throw InputError(file.name, frame.place,
                             fmt::format("{} seconds, unlike the first frame", timed ? "has no" : "has"),
                             "give them to all frames of a path, or to none");
        stage::CameraPathKey key = key_of(frame, file.name);
        key.time_s = timed ? *frame.seconds : static_cast<double>(path.keys.size()) / views_per_s;
        path.keys.push_back(key);
    }
    path.duration_s = timed ? transforms.duration_s.value_or(path.keys.back().time_s) : path.keys.back().time_s;
    expect_path_times(path, root["frames"]);
    return path;
}

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
    key.angle_y = degrees(node["fov"]);
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

// nerfstudio's data parser turns, moves and scales the world of a data set. This takes poses back to the data set's
// world, with +Y up, by the `transform` and `scale` of dataparser_transforms.json, where they were added to the file.
struct NerfstudioWorld {
    glm::dmat4 dataset_from_parsed{1};
    double scale = 1;

    explicit NerfstudioWorld(const JsonNode& root) {
        if (root.has("transform")) dataset_from_parsed = glm::inverse(json_pose(root["transform"]));
        if (root.has("scale")) scale = json_number(root["scale"], 1 / kMaxDistance_m, kMaxDistance_m, "a scale");
    }
    glm::dmat4 pose(glm::dmat4 parsed) const {
        parsed[3] = glm::dvec4(glm::dvec3(parsed[3]) / scale, 1);
        return glm::dmat4(kYUpFromZUp) * dataset_from_parsed * parsed;
    }
};

stage::CameraPathKey nerfstudio_key(const JsonNode& node, const char* matrix, const NerfstudioWorld& world) {
    for (const char* name : {matrix, "fov"})
        if (!node.has(name)) node.fail(fmt::format("has no {}", name), "save the path in nerfstudio's render panel");
    const JsonNode numbers = node[matrix];
    if (numbers.value.is_string())
        numbers.fail("is text, as old viewers wrote keyframes", "save the path anew, with its camera_path");
    expect_array(numbers, 16);
    glm::dmat4 parsed(1);
    for (size_t i = 0; i < 16; ++i) parsed[static_cast<int>(i % 4)][static_cast<int>(i / 4)] = json_number(numbers[i]);
    if (glm::length(glm::row(parsed, 3) - glm::dvec4(0, 0, 0, 1)) > 1e-3)
        numbers.fail("does not end with 0 0 0 1", "give 4×4 numbers row by row, camera to world");
    expect_rigid(numbers, parsed);
    stage::CameraPathKey key;
    set_pose(key, world.pose(parsed));
    key.angle_y = degrees(node["fov"]);
    if (node.has("render_time") && !node["render_time"].value.is_null())
        key.clip_time = json_number(node["render_time"], 0, 1, "a time of the clip");
    return key;
}

double nerfstudio_seconds(const JsonNode& node, const char* name) {
    return json_number(node[name], 1e-6, kMaxPathSeconds, "a duration in seconds");
}

// `camera_path` lists every image of the path, `fps` of them a second.
void add_nerfstudio_images(stage::CameraPath& path, const JsonNode& root) {
    if (path.fps == 0) root.fail("has no fps", "save the path in nerfstudio's render panel");
    const double fps = path.fps;
    const NerfstudioWorld world(root);
    const JsonNode images = root["camera_path"];
    for (size_t i = 0; i < images.value.size(); ++i) {
        path.keys.push_back(nerfstudio_key(images[i], "camera_to_world", world));
        path.keys.back().time_s = static_cast<double>(i) / fps;
    }
    path.duration_s = static_cast<double>(path.keys.size() - (path.cyclic ? 0 : 1)) / fps;
    expect_path_times(path, images);
}

// Where there are only `keyframes`, each has the time that it takes from the key before; the first key of a cycle has
// the time from the last.
void add_nerfstudio_keys(stage::CameraPath& path, const JsonNode& root) {
    const JsonNode keys = root["keyframes"];
    const auto steps = static_cast<double>(std::max<size_t>(1, keys.value.size() - (path.cyclic ? 0 : 1)));
    double usual = 0;
    if (root.has("default_transition_sec"))
        usual = nerfstudio_seconds(root, "default_transition_sec");
    else if (root.has("seconds"))
        usual = nerfstudio_seconds(root, "seconds") / steps;
    else
        root.fail("has neither default_transition_sec nor seconds", "save the path in nerfstudio's render panel");
    const NerfstudioWorld world(root);
    double first_step = 0;
    for (size_t i = 0; i < keys.value.size(); ++i) {
        const JsonNode node = keys[i];
        stage::CameraPathKey key = nerfstudio_key(node, "matrix", world);
        const bool overridden = node.has("override_transition_enabled") &&
                                json_flag(node["override_transition_enabled"]) && node.has("override_transition_sec");
        const double step = overridden ? nerfstudio_seconds(node, "override_transition_sec") : usual;
        if (i == 0)
            first_step = step;
        else
            key.time_s = path.keys.back().time_s + step;
        path.keys.push_back(key);
    }
    path.duration_s = path.keys.back().time_s + (path.cyclic ? first_step : 0);
    expect_path_times(path, keys);
}

stage::CameraPath nerfstudio_path(const JsonNode& root) {
    if (root.has("camera_type") && json_string(root["camera_type"]) != "perspective")
        root["camera_type"].fail("is not perspective: images are rendered by pinholes", "save a perspective path");
    stage::CameraPath path;
    path.cyclic = root.has("is_cycle") && json_flag(root["is_cycle"]);
    if (root.has("render_width") && root.has("render_height")) {
        const auto side = [&](const char* name) {
            return static_cast<uint32_t>(json_number(root[name], 1, media::kMaxImageSide, "an image's size"));
        };
        path.width = side("render_width");
        path.height = side("render_height");
    }
    if (root.has("fps")) path.fps = json_number(root["fps"], kMinFps, kMaxFps, "a rate of images");
    const bool images = root.has("camera_path") && (!root["camera_path"].value.empty() || !root.has("keyframes"));
    expect_list(root[images ? "camera_path" : "keyframes"]);
    (images ? add_nerfstudio_images : add_nerfstudio_keys)(path, root);
    return path;
}

json frame_json(const stage::CameraPath& path, const stage::CameraPathKey& key) {
    json frame = {{"seconds", key.time_s}};
    const glm::dmat3 axes = glm::mat3_cast(key.world_from_camera);
    for (int row = 0; row < 3; ++row)
        frame["transform_matrix"].push_back({axes[0][row], axes[1][row], axes[2][row], key.position[row]});
    frame["transform_matrix"].push_back({0, 0, 0, 1});
    if (key.clip_time) frame["time"] = *key.clip_time;
    if (key.angle_x) {
        frame["camera_angle_x"] = *key.angle_x;
    } else if (path.width == 0) {
        frame["camera_angle_y"] = key.angle_y;
    } else {
        const double fy = 0.5 * path.height / std::tan(0.5 * key.angle_y);
        frame["fl_x"] = key.stretch * fy;
        frame["fl_y"] = fy;
        frame["cx"] = 0.5 * path.width + key.shift.x * path.height;
        frame["cy"] = 0.5 * path.height + key.shift.y * path.height;
    }
    return frame;
}

}  // namespace

stage::CameraPath read_camera_path(const std::filesystem::path& file, double views_per_s) {
    const JsonFile document = read_json(file, "a camera path: a transforms.json, or one of instant-ngp or nerfstudio");
    const JsonNode root = document.root();
    if (root.has("frames")) return transforms_path(document, views_per_s);
    if (root.has("path")) return ngp_path(root);
    if (root.has("camera_path") || root.has("keyframes")) return nerfstudio_path(root);
    root.fail("is no camera path: it has neither frames nor path nor camera_path",
              "give a transforms.json, or a camera path of instant-ngp or nerfstudio");
}

void write_camera_path(const std::filesystem::path& file, const stage::CameraPath& path) {
    json document = {{"interpolation", stage::kInterpolationNames[static_cast<size_t>(path.interpolation)]},
                     {"loop", path.cyclic},
                     {"duration_seconds", path.duration_s}};
    if (path.width != 0) {
        document["w"] = path.width;
        document["h"] = path.height;
    }
    for (const stage::CameraPathKey& key : path.keys) document["frames"].push_back(frame_json(path, key));
    const std::string text = document.dump(1) + "\n";
    write_file_atomically(file, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

}  // namespace neuvv::training
