#include "training/transforms.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

namespace {

using json = nlohmann::json;

constexpr uint64_t kMaxJsonBytes = uint64_t{256} << 20;
constexpr size_t kMaxQuoted = 120;        // of a file's own text, in an error
constexpr double kRigidTolerance = 1e-3;  // files hold poses in as few as 4 digits
constexpr double kMaxDistance_m = 1e6;    // beyond it, floats no longer resolve a performer
constexpr double kMaxFocal_px = 1e7;
constexpr double kMinAngle = 1e-3;  // narrower or wider, the focal length means nothing

// A value and where it stands, for errors.
struct Node {
    const json& value;
    const std::string& file;
    std::string place;

    [[noreturn]] void fail(const std::string& problem, const std::string& mend = "") const {
        throw InputError(file, place, problem, mend);
    }
    Node operator[](size_t i) const { return {value[i], file, fmt::format("{}[{}]", place, i)}; }
    Node operator[](const char* key) const { return {value[key], file, place.empty() ? key : place + "." + key}; }
    bool has(const char* key) const { return value.contains(key); }
};

// Walks a file that does not parse and remembers how far it came.
struct PlaceFinder : nlohmann::json_sax<json> {
    struct Level {
        bool array;
        size_t index;
        std::string key;
    };
    std::vector<Level> levels;
    size_t byte = 0;

    bool next() {
        if (!levels.empty() && levels.back().array) ++levels.back().index;
        return true;
    }
    bool open(bool array) {
        levels.push_back({array, 0, ""});
        return true;
    }
    bool close() {
        levels.pop_back();
        return next();
    }
    bool null() override { return next(); }
    bool boolean(bool) override { return next(); }
    bool number_integer(number_integer_t) override { return next(); }
    bool number_unsigned(number_unsigned_t) override { return next(); }
    bool number_float(number_float_t, const string_t&) override { return next(); }
    bool string(string_t&) override { return next(); }
    bool binary(binary_t&) override { return next(); }
    bool start_object(size_t) override { return open(false); }
    bool end_object() override { return close(); }
    bool start_array(size_t) override { return open(true); }
    bool end_array() override { return close(); }
    bool key(string_t& name) override {
        levels.back().key = name;
        return true;
    }
    bool parse_error(size_t position, const std::string&, const json::exception&) override {
        byte = position;
        return false;
    }
    std::string place() const {
        std::string text;
        for (const Level& level : levels) {
            if (text.size() > kMaxQuoted) break;  // a file of brackets alone
            if (level.array)
                text += fmt::format("[{}]", level.index);
            else if (!level.key.empty())
                text += (text.empty() ? "" : ".") + level.key.substr(0, kMaxQuoted);
        }
        return text.empty() ? fmt::format("byte {}", byte) : fmt::format("{} (byte {})", text, byte);
    }
};

json parse(const std::string& file, const std::vector<uint8_t>& bytes) {
    try {
        return json::parse(bytes, nullptr, true, true);
    } catch (const json::exception& error) {
        PlaceFinder finder;
        json::sax_parse(bytes, &finder, json::input_format_t::json, true, true);
        const std::string text = error.what();  // "[json.exception.…] what is wrong"
        const size_t bracket = text.find("] ");
        throw InputError(file, finder.place(),
                         bracket == std::string::npos ? text : text.substr(bracket + 2, 2 * kMaxQuoted),
                         "complete or correct the JSON");
    }
}

double number(const Node& node) {
    if (!node.value.is_number()) node.fail(fmt::format("is a {}, not a number", node.value.type_name()));
    const double value = node.value.get<double>();
    if (!std::isfinite(value)) node.fail("is not finite");
    return value;
}

void expect_array(const Node& node, size_t size) {
    if (!node.value.is_array()) node.fail(fmt::format("is a {}, not an array", node.value.type_name()));
    if (node.value.size() != size) node.fail(fmt::format("has {} entries, not {}", node.value.size(), size));
}

uint32_t side(const Node& node) {
    const double value = number(node);
    if (value < 1 || value > kMaxImageSide || value != std::floor(value))
        node.fail(fmt::format("is {}, not a picture size in pixels, 1 to {}", value, kMaxImageSide));
    return static_cast<uint32_t>(value);
}

double focal(const Node& node) {
    const double value = number(node);
    if (value <= 0 || value > kMaxFocal_px) node.fail(fmt::format("is {}, not a focal length in pixels", value));
    return value;
}

double principal(const Node& node) {
    const double value = number(node);
    if (std::abs(value) > kMaxFocal_px) node.fail(fmt::format("is {}, not a place in the picture in pixels", value));
    return value;
}

// Terms of a lens that a camera_model knows: of k the first few, and whether p1 and p2.
struct CameraModel {
    const char* name;
    LensModel lens;
    size_t k_terms;
    bool tangential;
};
// nerfstudio reads one set of terms for all models of perspective cameras, whichever the name.
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

const CameraModel& find_model(const Node& node, const std::string& name) {
    std::string known;
    for (const CameraModel& model : kCameraModels) {
        if (name == model.name) return model;
        known += (known.empty() ? "" : ", ") + std::string(model.name);
    }
    node.fail(fmt::format("{} is not a lens that is modelled", name.substr(0, kMaxQuoted)),
              "undistort the pictures to one of " + known);
}

const std::string& string_of(const Node& node) {
    if (!node.value.is_string()) node.fail(fmt::format("is a {}, not a string", node.value.type_name()));
    return node.value.get_ref<const std::string&>();
}

// Terms that were not meant for this lens would bend it wrongly.
void expect_terms_of_model(const Node& node, const Intrinsics& in) {
    const CameraModel& model = find_model(node, in.camera_model.empty() ? kUnnamedModel : in.camera_model);
    for (size_t i = model.k_terms; i < in.k.size(); ++i)
        if (in.k[i] != 0) node.fail(fmt::format("k{} is no term of the lens model {}", i + 1, model.name), "remove it");
    if (!model.tangential && (in.p1 != 0 || in.p2 != 0))
        node.fail(fmt::format("p1, p2 are no terms of the lens model {}", model.name), "remove them");
    if (model.lens == LensModel::kFisheye && !in.fl_x)
        node.fail("is a fisheye with an angle of view, which says nothing of its focal length", "give fl_x in pixels");
}

void read_lens(const Node& node, Intrinsics& result) {
    if (node.has("ftheta_p0")) node["ftheta_p0"].fail("f-theta lenses are not modelled", "undistort the pictures");
    if (node.has("rolling_shutter") && node["rolling_shutter"].value.is_array())
        for (size_t i = 0; i < node["rolling_shutter"].value.size(); ++i)
            if (number(node["rolling_shutter"][i]) != 0)
                node["rolling_shutter"].fail("rolling shutters are not modelled", "remove the field to do without");
    if (node.has("camera_model"))
        result.camera_model = find_model(node["camera_model"], string_of(node["camera_model"])).name;
    if (node.has("is_fisheye")) {
        if (!node["is_fisheye"].value.is_boolean()) node["is_fisheye"].fail("is neither true nor false");
        if (node["is_fisheye"].value.get<bool>()) result.camera_model = kUnnamedFisheye;
    }
    if (!result.camera_model.empty()) result.lens_model = find_model(node, result.camera_model).lens;
    for (size_t i = 0; i < result.k.size(); ++i)
        if (const std::string key = fmt::format("k{}", i + 1); node.has(key.c_str()))
            result.k[i] = number(node[key.c_str()]);
    if (node.has("p1")) result.p1 = number(node["p1"]);
    if (node.has("p2")) result.p2 = number(node["p2"]);
}

// The fields of one level (the file, or a frame) over those of the level above it.
Intrinsics read_intrinsics(const Node& node, Intrinsics result) {
    read_lens(node, result);
    if (node.has("fl_x") || node.has("camera_angle_x"))  // a new focal length replaces the old one whole
        result.fl_x = result.fl_y = result.camera_angle_x = std::nullopt;
    if (node.has("camera_angle_x")) {
        result.camera_angle_x = number(node["camera_angle_x"]);
        if (*result.camera_angle_x < kMinAngle || *result.camera_angle_x > std::numbers::pi - kMinAngle)
            node["camera_angle_x"].fail("is not between 0 and π", "give the horizontal angle of view in radians");
    }
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

void expect_rigid(const Node& node, const glm::dmat4& pose) {
    const glm::dmat3 axes(pose);
    const glm::dvec3 lengths(glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]));
    for (int i = 0; i < 3; ++i)
        if (std::abs(lengths[i] - 1) > kRigidTolerance)
            node.fail(
                fmt::format("is scaled: its axes have lengths {:.4g}, {:.4g}, {:.4g}", lengths.x, lengths.y, lengths.z),
                "divide the scale out of the left 3×3 part");
    const double skew = std::max({std::abs(glm::dot(axes[0], axes[1])), std::abs(glm::dot(axes[1], axes[2])),
                                  std::abs(glm::dot(axes[2], axes[0]))});
    if (skew > kRigidTolerance) node.fail("is sheared: its axes are not at right angles", "give a rigid pose");
    if (glm::determinant(axes) < 0)
        node.fail("is left-handed (determinant -1)", "flip one axis: +X right, +Y up, the camera looks along -Z");
    for (int i = 0; i < 3; ++i)
        if (std::abs(pose[3][i]) > kMaxDistance_m)
            node.fail(fmt::format("stands more than {} m from the origin", kMaxDistance_m), "give metres");
}

glm::dmat4 read_pose(const Node& node) {
    if (!node.value.is_array()) node.fail(fmt::format("is a {}, not an array", node.value.type_name()));
    const size_t rows = node.value.size();
    if (rows != 3 && rows != 4) node.fail(fmt::format("has {} rows", rows), "give 4×4 or 3×4 numbers, row by row");
    glm::dmat4 pose(1);
    for (size_t row = 0; row < rows; ++row) {
        expect_array(node[row], 4);
        for (size_t column = 0; column < 4; ++column)
            pose[static_cast<int>(column)][static_cast<int>(row)] = number(node[row][column]);
    }
    for (int column = 0; column < 4; ++column)
        if (std::abs(pose[column][3] - (column == 3 ? 1 : 0)) > kRigidTolerance)
            node[3].fail("is not 0 0 0 1", "give the matrix row by row, camera to world");
    expect_rigid(node, pose);
    return pose;
}

// A data set reads nothing outside its folder.
std::string read_path(const Node& node) {
    const std::string& name = string_of(node);
    const std::filesystem::path path(name);
    if (name.empty() || name.find('\0') != std::string::npos) node.fail("is not a file name");
    if (path.is_absolute()) node.fail("is an absolute path", "give it relative to the folder of this file");
    for (const auto& part : path)
        if (part == "..")
            node.fail("leads out of the data set's folder", "move the file inside and name it without ..");
    return name;
}

TransformsFrame read_frame(const Node& node, const Intrinsics& common) {
    if (!node.value.is_object()) node.fail(fmt::format("is a {}, not an object", node.value.type_name()));
    TransformsFrame frame;
    frame.place = node.place;
    frame.intrinsics = read_intrinsics(node, common);
    if (!frame.intrinsics.fl_x && !frame.intrinsics.camera_angle_x)
        node.fail("has no focal length", "give camera_angle_x or fl_x, here or at the top of the file");
    expect_terms_of_model(node, frame.intrinsics);
    if (!node.has("transform_matrix")) node.fail("has no transform_matrix", "give its pose, camera to world");
    frame.world_from_camera = read_pose(node["transform_matrix"]);
    if (node.has("file_path")) frame.file_path = read_path(node["file_path"]);
    if (node.has("background_path")) frame.background_path = read_path(node["background_path"]);
    if (node.has("mask_path")) frame.mask_path = read_path(node["mask_path"]);
    if (node.has("time")) {
        frame.time = number(node["time"]);
        if (*frame.time < 0 || *frame.time > 1)
            node["time"].fail(fmt::format("is {}, outside [0,1]", *frame.time),
                              "0 is the clip's first frame, 1 its last");
    }
    return frame;
}

std::pair<glm::dvec3, glm::dvec3> read_box(const Node& node) {
    expect_array(node, 2);
    std::pair<glm::dvec3, glm::dvec3> box;
    for (size_t corner = 0; corner < 2; ++corner) {
        expect_array(node[corner], 3);
        for (size_t i = 0; i < 3; ++i)
            (corner == 0 ? box.first : box.second)[static_cast<int>(i)] = number(node[corner][i]);
    }
    for (int i = 0; i < 3; ++i)
        if (!(box.first[i] < box.second[i]) || std::max(-box.first[i], box.second[i]) > kMaxDistance_m)
            node.fail("is not a box", "give [[min x, y, z], [max x, y, z]] in metres");
    return box;
}

// From instant-ngp's cube to the coordinates of its poses: axes cycled, scaled and moved.
std::pair<glm::dvec3, glm::dvec3> box_from_ngp(const Node& root, std::pair<glm::dvec3, glm::dvec3> box) {
    const double scale = root.has("scale") ? number(root["scale"]) : 0.33;
    if (!(scale > 1 / kMaxDistance_m && scale < kMaxDistance_m)) root["scale"].fail("is not a scale");
    glm::dvec3 offset(0.5);
    if (root.has("offset")) {
        expect_array(root["offset"], 3);
        for (size_t i = 0; i < 3; ++i) offset[static_cast<int>(i)] = number(root["offset"][i]);
    }
    const auto back = [&](glm::dvec3 p) { return (glm::dvec3(p.z, p.x, p.y) - offset) / scale; };
    return {back(box.first), back(box.second)};
}

// (x, y, z) → (x, z, −y)
const glm::dmat3 kYUpFromZUp(1, 0, 0, 0, 0, -1, 0, 1, 0);

bool is_z_up(const Node& root) {
    if (root.has("camera_model") || root.has("aabb_scale")) return true;
    for (const json& frame : root["frames"].value)
        if (frame.contains("rotation")) return true;
    return false;
}

// Poses and box into our world.
void convert_world(const Node& root, Transforms& result) {
    double scale = 1;
    if (root.has("applied_scale")) {
        scale = number(root["applied_scale"]);
        if (!(scale > 1 / kMaxDistance_m && scale < kMaxDistance_m)) root["applied_scale"].fail("is not a scale");
    }
    if (result.box && root.has("aabb_scale")) result.box = box_from_ngp(root, *result.box);
    const glm::dmat3 turn = is_z_up(root) ? kYUpFromZUp : glm::dmat3(1);
    for (TransformsFrame& frame : result.frames) {
        frame.world_from_camera = glm::dmat4(turn) * frame.world_from_camera;
        frame.world_from_camera[3] = glm::dvec4(glm::dvec3(frame.world_from_camera[3]) / scale, 1);
    }
    if (!result.box) return;
    const glm::dvec3 a = turn * result.box->first / scale, b = turn * result.box->second / scale;
    result.box = {glm::min(a, b), glm::max(a, b)};
}

std::optional<std::vector<std::string>> read_file_list(const Node& root, const char* key) {
    if (!root.has(key)) return std::nullopt;
    const Node list = root[key];
    if (!list.value.is_array()) list.fail(fmt::format("is a {}, not an array", list.value.type_name()));
    std::vector<std::string> files;
    for (size_t i = 0; i < list.value.size(); ++i) files.push_back(string_of(list[i]));
    return files;
}

}  // namespace

Transforms read_transforms(const std::filesystem::path& file) {
    const std::string name = file.string();
    const json document = parse(name, read_file(file, kMaxJsonBytes));
    const Node root{document, name, ""};
    if (!document.is_object()) root.fail("is not a JSON object", "give a transforms.json of the NeRF family");
    Transforms result;
    const Intrinsics common = read_intrinsics(root, {});
    if (root.has("aabb")) result.box = read_box(root["aabb"]);
    if (root.has("fps")) {
        result.fps = number(root["fps"]);
        if (result.fps <= 0 || result.fps > 1e6) root["fps"].fail("is not a number of frames a second");
    }
    if (!root.has("frames")) root.fail("has no frames", "give a transforms.json of the NeRF family");
    const Node frames = root["frames"];
    if (!frames.value.is_array() || frames.value.empty()) frames.fail("is not an array of frames");
    result.frames.reserve(frames.value.size());
    for (size_t i = 0; i < frames.value.size(); ++i) result.frames.push_back(read_frame(frames[i], common));
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
    lens.fx = in.fl_x ? *in.fl_x : 0.5 * width / std::tan(0.5 * in.camera_angle_x.value());
    lens.fy = in.fl_y.value_or(lens.fx);
    lens.cx = in.cx.value_or(0.5 * width);
    lens.cy = in.cy.value_or(0.5 * height);
    return lens;
}

}  // namespace neuvv
