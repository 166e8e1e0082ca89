// Camera paths of nerfstudio.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>

#include "base/output_path.h"
#include "interchange/camera/camera_path_file.h"
#include "interchange/camera/camera_path_formats.h"
#include "media/image.h"

namespace neuvv::interchange {

namespace {

using nerfstudio_json = nlohmann::ordered_json;

constexpr double kMinFps = 0.01, kMaxFps = 1e4;
constexpr double kTension = 0;  // of nerfstudio's own spline through keyframes

// nerfstudio's data parser turns, moves and scales the world of a data set. This takes poses back to the data set's
// world, with +Y up, by the `transform` and `scale` of dataparser_transforms.json, where they were added to the file.
// Its `transform` begins before the `applied_transform` of the data set (nerfstudio_dataparser.py), which poses have.
struct NerfstudioWorld {
    glm::dmat4 dataset_from_parsed{1};
    double scale = 1;

    explicit NerfstudioWorld(const JsonNode& root) {
        if (root.has("transform")) dataset_from_parsed = glm::inverse(json_pose(root["transform"]));
        if (root.has("applied_transform"))
            dataset_from_parsed = json_pose(root["applied_transform"]) * dataset_from_parsed;
        if (root.has("scale")) scale = json_number(root["scale"], 1 / kMaxDistance_m, kMaxDistance_m, "a scale");
    }
    glm::dmat4 pose(glm::dmat4 parsed) const {
        parsed[3] = glm::dvec4(glm::dvec3(parsed[3]) / scale, 1);
        return glm::dmat4(kYUpFromZUp) * dataset_from_parsed * parsed;
    }
    // The inverse.
    glm::dmat4 parsed(const glm::dmat4& world_from_camera) const {
        glm::dmat4 parsed =
            glm::inverse(dataset_from_parsed) * glm::transpose(glm::dmat4(kYUpFromZUp)) * world_from_camera;
        parsed[3] = glm::dvec4(glm::dvec3(parsed[3]) * scale, 1);
        return parsed;
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
    key.angle_y = path_degrees(node["fov"]);
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

nerfstudio_json numbers_of(const stage::CameraPathKey& key, const NerfstudioWorld& world) {
    glm::dmat4 pose(glm::mat3_cast(key.world_from_camera));
    pose[3] = glm::dvec4(key.position, 1);
    const glm::dmat4 parsed = world.parsed(pose);
    nerfstudio_json numbers = nerfstudio_json::array();
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) numbers.push_back(parsed[column][row]);
    return numbers;
}

nerfstudio_json image_json(const stage::CameraPathKey& key, const char* matrix, double aspect,
                           const NerfstudioWorld& world) {
    nerfstudio_json image = {{matrix, numbers_of(key, world)}, {"fov", glm::degrees(key.angle_y)}, {"aspect", aspect}};
    if (key.clip_time) image["render_time"] = *key.clip_time;
    return image;
}

// The keys from which nerfstudio's viewer makes a spline of its own, each with the seconds from the one before.
nerfstudio_json keyframes_of(const stage::CameraPath& path, const stage::CameraPath& images, double aspect,
                             const NerfstudioWorld& world) {
    nerfstudio_json keyframes = nerfstudio_json::array();
    for (size_t i = 0; i < path.keys.size(); ++i) {
        const double time_s = path.keys[i].time_s;
        stage::CameraPathKey key = stage::key_of(stage::camera_at(path, time_s, images.width, images.height), time_s);
        key.clip_time = path.keys[i].clip_time;
        nerfstudio_json keyframe = image_json(key, "matrix", aspect, world);
        const double from_s = i > 0 ? path.keys[i - 1].time_s : path.keys.back().time_s - path.duration_s;
        keyframe["override_transition_enabled"] = i > 0 || path.cyclic;
        keyframe["override_transition_sec"] =
            i > 0 || path.cyclic ? nerfstudio_json(time_s - from_s) : nerfstudio_json();
        keyframes.push_back(std::move(keyframe));
    }
    return keyframes;
}

}  // namespace

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

void write_nerfstudio_path(const std::filesystem::path& file, const stage::CameraPath& path,
                           const stage::CameraPath& images, const std::filesystem::path& world) {
    nerfstudio_json document;
    const nlohmann::json none = nlohmann::json::object();
    const std::string name = world.string();
    JsonFile parser{name, none};
    if (!world.empty()) parser = read_json(world, "a dataparser_transforms.json of nerfstudio");
    const NerfstudioWorld parsed(parser.root());
    const double aspect = static_cast<double>(images.width) / images.height;
    const auto count = static_cast<double>(images.keys.size());
    document["default_fov"] = glm::degrees(images.keys[0].angle_y);
    document["default_transition_sec"] =
        std::max(path.duration_s, 1 / images.fps) / static_cast<double>(path.keys.size());
    document["keyframes"] = keyframes_of(path, images, aspect, parsed);
    document["camera_type"] = "perspective";
    document["render_height"] = images.height;
    document["render_width"] = images.width;
    document["fps"] = images.fps;
    document["seconds"] = count / images.fps;
    document["is_cycle"] = images.cyclic;
    document["smoothness_value"] = kTension;
    for (const stage::CameraPathKey& key : images.keys)
        document["camera_path"].push_back(image_json(key, "camera_to_world", aspect, parsed));
    document["crop"] = nullptr;
    for (const char* member : {"transform", "scale", "applied_transform"})
        if (parser.document.contains(member)) document[member] = parser.document[member];
    write_text_file(file, document.dump(1) + "\n");
}

}  // namespace neuvv::interchange
