#include "interchange/camera/camera_path_file.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "base/text.h"
#include "interchange/camera/camera_path_formats.h"
#include "interchange/stage/camera_usd.h"
#include "stage/camera_path_json.h"
#include "stage/evaluated_stage.h"

namespace neuvv::interchange {

namespace {

constexpr double kMinAngle_deg = 0.1, kMaxAngle_deg = 179;

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

nlohmann::json frame_json(const stage::CameraPath& path, const stage::CameraPathKey& key) {
    nlohmann::json frame = {{"seconds", key.time_s}};
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

void set_pose(stage::CameraPathKey& key, const glm::dmat4& world_from_camera) {
    key.position = glm::dvec3(world_from_camera[3]);
    key.world_from_camera = glm::normalize(glm::quat_cast(glm::dmat3(world_from_camera)));
}

double path_degrees(const JsonNode& node) {
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

namespace {

stage::CameraPath path_of_document(const std::filesystem::path& file, double views_per_s) {
    const JsonFile document = read_json(file, "a camera path: a transforms.json, or one of instant-ngp or nerfstudio");
    const JsonNode root = document.root();
    if (root.has("frames")) return transforms_path(document, views_per_s);
    if (root.has("path")) return ngp_path(root);
    if (root.has("camera_path") || root.has("keyframes")) return nerfstudio_path(root);
    root.fail("is no camera path: it has neither frames nor path nor camera_path",
              "give a transforms.json, or a camera path of instant-ngp or nerfstudio");
}

}  // namespace

voctree::WorldFrame frame_of(const stage::Stage& stage) {
    std::optional<voctree::WorldFrame> frame;
    for (const stage::StageClip& clip : stage.clips) {
        const voctree::WorldFrame of_clip = voctree::read_world_frame(clip.path);
        if (frame && *frame != of_clip) return {};
        frame = of_clip;
    }
    return frame.value_or(voctree::WorldFrame{});
}

stage::CameraPath in_capture(stage::CameraPath path, const voctree::WorldFrame& frame) {
    for (stage::CameraPathKey& key : path.keys) key.position = frame.to_capture(key.position);
    return path;
}

stage::CameraPath read_camera_path(const std::filesystem::path& file, double views_per_s,
                                   const voctree::WorldFrame& frame) {
    const std::string ending = lower_case(file.extension().string());
    if (ending == ".gltf" || ending == ".glb") return stage::path_of_camera(stage::load_stage(file), "", views_per_s);
    stage::CameraPath path = ending == ".usda" ? read_camera_usda(file) : path_of_document(file, views_per_s);
    for (stage::CameraPathKey& key : path.keys) key.position = frame.from_capture(key.position);
    return path;
}

void write_camera_path(const std::filesystem::path& file, const stage::CameraPath& path) {
    nlohmann::json document = {{"interpolation", stage::kInterpolationNames[static_cast<size_t>(path.interpolation)]},
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

}  // namespace neuvv::interchange
