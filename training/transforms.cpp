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

void expect_no_distortion(const Node& node) {
    for (const char* key : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"})
        if (node.has(key) && number(node[key]) != 0)
            node[key].fail("lens distortion is not modelled", "undistort the pictures and remove the field");
}

// The fields of one level (the file, or a frame) over those of the level above it.
Intrinsics read_intrinsics(const Node& node, Intrinsics result) {
    expect_no_distortion(node);
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
    if (!node.value.is_string()) node.fail(fmt::format("is a {}, not a string", node.value.type_name()));
    const auto& text = node.value.get_ref<const std::string&>();
    const std::filesystem::path path(text);
    if (text.empty() || text.find('\0') != std::string::npos) node.fail("is not a file name");
    if (path.is_absolute()) node.fail("is an absolute path", "give it relative to the folder of this file");
    for (const auto& part : path)
        if (part == "..")
            node.fail("leads out of the data set's folder", "move the file inside and name it without ..");
    return text;
}

TransformsFrame read_frame(const Node& node, const Intrinsics& common) {
    if (!node.value.is_object()) node.fail(fmt::format("is a {}, not an object", node.value.type_name()));
    TransformsFrame frame;
    frame.place = node.place;
    frame.intrinsics = read_intrinsics(node, common);
    if (!frame.intrinsics.fl_x && !frame.intrinsics.camera_angle_x)
        node.fail("has no focal length", "give camera_angle_x or fl_x, here or at the top of the file");
    if (!node.has("transform_matrix")) node.fail("has no transform_matrix", "give its pose, camera to world");
    frame.world_from_camera = read_pose(node["transform_matrix"]);
    if (node.has("file_path")) frame.file_path = read_path(node["file_path"]);
    if (node.has("background_path")) frame.background_path = read_path(node["background_path"]);
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
    return result;
}

Camera make_camera(const TransformsFrame& frame, uint32_t width, uint32_t height) {
    const Intrinsics& in = frame.intrinsics;
    Camera camera;
    camera.world_from_camera = frame.world_from_camera;
    camera.width = width;
    camera.height = height;
    camera.fx = in.fl_x ? *in.fl_x : 0.5 * width / std::tan(0.5 * in.camera_angle_x.value());
    camera.fy = in.fl_y.value_or(camera.fx);
    camera.cx = in.cx.value_or(0.5 * width);
    camera.cy = in.cy.value_or(0.5 * height);
    return camera;
}

}  // namespace neuvv
