#include "interchange/camera/transforms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "media/image.h"

namespace neuvv::interchange {

namespace {

constexpr double kMaxFocal_px = 1e7;
constexpr double kMinAngle = 1e-3;  // radians from 0 and from π, where an angle of view gives no sensible focal length

uint32_t side(const JsonNode& node) {
    const double value = json_number(node);
    if (value < 1 || value > media::kMaxImageSide || value != std::floor(value))
        node.fail(fmt::format("is {}, not an image size in pixels, 1 to {}", value, media::kMaxImageSide));
    return static_cast<uint32_t>(value);
}

double focal(const JsonNode& node) {
    const double value = json_number(node);
    if (value <= 0 || value > kMaxFocal_px) node.fail(fmt::format("is {}, not a focal length in pixels", value));
    return value;
}

double principal(const JsonNode& node) {
    const double value = json_number(node);
    if (std::abs(value) > kMaxFocal_px) node.fail(fmt::format("is {}, not a position in the image in pixels", value));
    return value;
}

double angle(const JsonNode& node, const char* direction) {
    const double value = json_number(node);
    if (value < kMinAngle || value > std::numbers::pi - kMinAngle)
        node.fail("is not between 0 and π", fmt::format("give the {} angle of view in radians", direction));
    return value;
}

// A camera_model: its lens, and which terms of distortion it has: the first k_terms of k, and whether p1 and p2.
struct CameraModel {
    const char* name;
    LensModel lens;
    size_t k_terms;
    bool tangential;
};
// nerfstudio reads the same terms for all models of perspective cameras, whatever their names.
constexpr CameraModel kCameraModels[] = {
    {"OPENCV", LensModel::kBrown, 3, true},
    {"PINHOLE", LensModel::kBrown, 3, true},
    {"SIMPLE_PINHOLE", LensModel::kBrown, 3, true},
    {"SIMPLE_RADIAL", LensModel::kBrown, 3, true},
    {"RADIAL", LensModel::kBrown, 3, true},
    {"FULL_OPENCV", LensModel::kBrown, 6, true},
    {"OPENCV_FISHEYE", LensModel::kFisheye, 4, false},
    {"SIMPLE_RADIAL_FISHEYE", LensModel::kFisheye, 4, false},
    {"RADIAL_FISHEYE", LensModel::kFisheye, 4, false},
};
constexpr char kUnnamedModel[] = "OPENCV", kUnnamedFisheye[] = "OPENCV_FISHEYE";

const CameraModel& find_model(const JsonNode& node, const std::string& name) {
    std::string known;
    for (const CameraModel& model : kCameraModels) {
        if (name == model.name) return model;
        known += (known.empty() ? "" : ", ") + std::string(model.name);
    }
    node.fail(fmt::format("{} is not a lens that is modelled", name.substr(0, kMaxQuoted)),
              "undistort the images to one of " + known);
}

// Refuses terms that the lens model does not have, and fisheye lenses that are given by an angle of view.
void expect_terms_of_model(const JsonNode& node, const Intrinsics& in) {
    const CameraModel& model = find_model(node, in.camera_model.empty() ? kUnnamedModel : in.camera_model);
    for (size_t i = model.k_terms; i < in.k.size(); ++i)
        if (in.k[i] != 0) node.fail(fmt::format("k{} is no term of the lens model {}", i + 1, model.name), "remove it");
    if (!model.tangential && (in.p1 != 0 || in.p2 != 0))
        node.fail(fmt::format("p1, p2 are no terms of the lens model {}", model.name), "remove them");
    if (model.lens == LensModel::kFisheye && !in.fl_x && !in.fl_y)
        node.fail("is a fisheye with an angle of view, which says nothing of its focal length", "give fl_x in pixels");
}

void read_lens(const JsonNode& node, Intrinsics& result) {
    if (node.has("ftheta_p0")) node["ftheta_p0"].fail("f-theta lenses are not modelled", "undistort the images");
    if (node.has("rolling_shutter") && node["rolling_shutter"].value.is_array())
        for (size_t i = 0; i < node["rolling_shutter"].value.size(); ++i)
            if (json_number(node["rolling_shutter"][i]) != 0)
                node["rolling_shutter"].fail("rolling shutters are not modelled", "remove the field to do without");
    if (node.has("camera_model"))
        result.camera_model = find_model(node["camera_model"], json_string(node["camera_model"])).name;
    if (node.has("is_fisheye")) {
        if (json_flag(node["is_fisheye"])) result.camera_model = kUnnamedFisheye;
    }
    if (!result.camera_model.empty()) result.lens_model = find_model(node, result.camera_model).lens;
    for (size_t i = 0; i < result.k.size(); ++i)
        if (const std::string key = fmt::format("k{}", i + 1); node.has(key.c_str()))
            result.k[i] = json_number(node[key.c_str()]);
    if (node.has("p1")) result.p1 = json_number(node["p1"]);
    if (node.has("p2")) result.p2 = json_number(node["p2"]);
}

// Reads the fields of the file or of a frame; `result` has the values of the level above, which they replace.
Intrinsics read_intrinsics(const JsonNode& node, Intrinsics result) {
    read_lens(node, result);
    // A new focal length replaces the old one entirely, in whatever form either is given.
    if (node.has("fl_x") || node.has("camera_angle_x") || node.has("camera_angle_y"))
        result.fl_x = result.fl_y = result.camera_angle_x = result.camera_angle_y = std::nullopt;
    if (node.has("camera_angle_x")) result.camera_angle_x = angle(node["camera_angle_x"], "horizontal");
    if (node.has("camera_angle_y")) result.camera_angle_y = angle(node["camera_angle_y"], "vertical");
    if (node.has("fl_x")) result.fl_x = focal(node["fl_x"]);
    if (node.has("fl_y")) result.fl_y = focal(node["fl_y"]);
    if (node.has("cx")) result.cx = principal(node["cx"]);
    if (node.has("cy")) result.cy = principal(node["cy"]);
    if (node.has("w") != node.has("h")) node.fail("w and h come together", "give both or neither");
    if (node.has("w")) {
        result.width = side(node["w"]);
        result.height = side(node["h"]);
    }
    return result;
}

// Programs of Windows write backslashes for slashes.
std::string with_slashes(std::string path) {
    std::ranges::replace(path, '\\', '/');
    return path;
}

// A data set reads nothing outside its folder.
std::string read_path(const JsonNode& node) {
    const std::string name = with_slashes(json_string(node));
    const std::filesystem::path path(name);
    if (name.empty() || name.find('\0') != std::string::npos) node.fail("is not a file name");
    if (path.is_absolute() || (name.size() > 2 && name[1] == ':' && name[2] == '/'))
        node.fail("is an absolute path", "give it relative to the folder of this file");
    for (const auto& part : path)
        if (part == "..")
            node.fail("leads out of the data set's folder", "move the file inside and name it without ..");
    return name;
}

TransformsFrame read_frame(const JsonNode& node, const Intrinsics& common) {
    if (!node.value.is_object()) node.fail(fmt::format("is a {}, not an object", node.value.type_name()));
    TransformsFrame frame;
    frame.place = node.place;
    frame.intrinsics = read_intrinsics(node, common);
    const Intrinsics& in = frame.intrinsics;
    if (!in.fl_x && !in.fl_y && !in.camera_angle_x && !in.camera_angle_y)
        node.fail("has no focal length", "give camera_angle_x or fl_x, here or at the top of the file");
    expect_terms_of_model(node, frame.intrinsics);
    if (!node.has("transform_matrix")) node.fail("has no transform_matrix", "give its pose, camera to world");
    frame.world_from_camera = json_pose(node["transform_matrix"]);
    if (node.has("file_path")) frame.file_path = read_path(node["file_path"]);
    if (node.has("background_path")) frame.background_path = read_path(node["background_path"]);
    if (node.has("mask_path")) frame.mask_path = read_path(node["mask_path"]);
    if (node.has("time")) {
        frame.time = json_number(node["time"]);
        if (*frame.time < 0 || *frame.time > 1)
            node["time"].fail(fmt::format("is {}, outside [0,1]", *frame.time),
                              "0 is the clip's first frame, 1 its last");
    }
    if (node.has("seconds"))
        frame.seconds = json_number(node["seconds"], 0, kMaxPathSeconds, "a time on a camera path in seconds");
    return frame;
}

std::pair<glm::dvec3, glm::dvec3> read_box(const JsonNode& node) {
    expect_array(node, 2);
    std::pair<glm::dvec3, glm::dvec3> box;
    for (size_t corner = 0; corner < 2; ++corner) {
        expect_array(node[corner], 3);
        for (size_t i = 0; i < 3; ++i)
            (corner == 0 ? box.first : box.second)[static_cast<int>(i)] = json_number(node[corner][i]);
    }
    for (int i = 0; i < 3; ++i)
        if (!(box.first[i] < box.second[i]) || std::max(-box.first[i], box.second[i]) > kMaxDistance_m)
            node.fail("is not a box", "give [[min x, y, z], [max x, y, z]] in metres");
    return box;
}

bool is_z_up(const JsonNode& root) {
    if (root.has("camera_model") || root.has("aabb_scale")) return true;
    for (const nlohmann::json& frame : root["frames"].value)
        if (frame.contains("rotation")) return true;
    return false;
}

// Takes poses and box to a world with +Y up and the capture's units.
void convert_world(const JsonNode& root, Transforms& result) {
    double scale = 1;
    if (root.has("applied_scale")) {
        scale = json_number(root["applied_scale"]);
        if (!(scale > 1 / kMaxDistance_m && scale < kMaxDistance_m)) root["applied_scale"].fail("is not a scale");
    }
    if (result.box && root.has("aabb_scale")) {
        const NgpCube cube = read_ngp_cube(root);
        result.box = {cube.to_world(result.box->first), cube.to_world(result.box->second)};
    }
    result.z_up = is_z_up(root);
    const glm::dmat3 turn = result.z_up ? kYUpFromZUp : glm::dmat3(1);
    for (TransformsFrame& frame : result.frames) {
        frame.world_from_camera = glm::dmat4(turn) * frame.world_from_camera;
        frame.world_from_camera[3] = glm::dvec4(glm::dvec3(frame.world_from_camera[3]) / scale, 1);
    }
    if (!result.box) return;
    const glm::dvec3 a = turn * result.box->first / scale, b = turn * result.box->second / scale;
    result.box = {glm::min(a, b), glm::max(a, b)};
}

std::optional<std::vector<std::string>> read_file_list(const JsonNode& root, const char* key) {
    if (!root.has(key)) return std::nullopt;
    const JsonNode list = root[key];
    if (!list.value.is_array()) list.fail(fmt::format("is a {}, not an array", list.value.type_name()));
    std::vector<std::string> files;
    for (size_t i = 0; i < list.value.size(); ++i) files.push_back(with_slashes(json_string(list[i])));
    return files;
}

}  // namespace

NgpCube read_ngp_cube(const JsonNode& root) {
    NgpCube cube;
    if (root.has("scale")) cube.scale = json_number(root["scale"]);
    if (!(cube.scale > 1 / kMaxDistance_m && cube.scale < kMaxDistance_m)) root["scale"].fail("is not a scale");
    if (root.has("offset")) {
        expect_array(root["offset"], 3);
        for (size_t i = 0; i < 3; ++i) cube.offset[static_cast<int>(i)] = json_number(root["offset"][i]);
    }
    return cube;
}

Transforms read_transforms(const std::filesystem::path& file) {
    return transforms_of(read_json(file, "a transforms.json of the NeRF family"));
}

Transforms transforms_of(const JsonFile& file) {
    const JsonNode root = file.root();
    Transforms result;
    const Intrinsics common = read_intrinsics(root, {});
    if (root.has("aabb")) result.box = read_box(root["aabb"]);
    if (root.has("fps")) {
        result.fps = json_number(root["fps"]);
        if (result.fps <= 0 || result.fps > 1e6) root["fps"].fail("is not a number of frames a second");
    }
    if (!root.has("frames")) root.fail("has no frames", "give a transforms.json of the NeRF family");
    const JsonNode frames = root["frames"];
    if (!frames.value.is_array() || frames.value.empty()) frames.fail("is not an array of frames");
    result.frames.reserve(frames.value.size());
    for (size_t i = 0; i < frames.value.size(); ++i) result.frames.push_back(read_frame(frames[i], common));
    if (root.has("loop")) result.loop = json_flag(root["loop"]);
    if (root.has("duration_seconds"))
        result.duration_s = json_number(root["duration_seconds"], 0, kMaxPathSeconds, "a path's duration in seconds");
    if (root.has("interpolation")) result.interpolation = json_string(root["interpolation"]);
    result.split_files = {read_file_list(root, "train_filenames"), read_file_list(root, "test_filenames"),
                          read_file_list(root, "val_filenames")};
    convert_world(root, result);
    return result;
}

Lens make_lens(const Intrinsics& in, uint32_t width, uint32_t height) {
    Lens lens;
    lens.model = in.lens_model;
    lens.k = in.k;
    lens.p1 = in.p1;
    lens.p2 = in.p2;
    lens.width = width;
    lens.height = height;
    const auto focal_length = [](std::optional<double> pixels, std::optional<double> angle, uint32_t side) {
        if (!pixels && angle) pixels = 0.5 * side / std::tan(0.5 * *angle);
        return pixels;
    };
    const auto across = focal_length(in.fl_x, in.camera_angle_x, width);
    const auto down = focal_length(in.fl_y, in.camera_angle_y, height);
    lens.fx = across ? *across : down.value();
    lens.fy = down.value_or(lens.fx);
    lens.cx = in.cx.value_or(0.5 * width);
    lens.cy = in.cy.value_or(0.5 * height);
    return lens;
}

}  // namespace neuvv::interchange
