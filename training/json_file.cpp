#include "training/json_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::training {

namespace {

using json = nlohmann::json;

constexpr uint64_t kMaxJsonBytes = uint64_t{256} << 20;
constexpr double kRigidTolerance = 1e-3;  // files hold poses in as few as 4 digits

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

[[noreturn]] void fail_type(const JsonNode& node, const char* expected) {
    node.fail(fmt::format("is a {}, not {}", node.value.type_name(), expected));
}

}  // namespace

void JsonNode::fail(const std::string& problem, const std::string& mend) const {
    throw InputError(file, place, problem, mend);
}

JsonNode JsonNode::operator[](size_t i) const {
    return {value[i], file, fmt::format("{}[{}]", place, i)};
}

JsonNode JsonNode::operator[](const char* key) const {
    return {value[key], file, place.empty() ? key : place + "." + key};
}

JsonFile read_json(const std::filesystem::path& file, const std::string& expected) {
    JsonFile result{file.string(), {}};
    result.document = parse(result.name, read_file(file, kMaxJsonBytes));
    if (!result.document.is_object()) result.root().fail("is not a JSON object", "give " + expected);
    return result;
}

double json_number(const JsonNode& node) {
    if (!node.value.is_number()) fail_type(node, "a number");
    const double value = node.value.get<double>();
    if (!std::isfinite(value)) node.fail("is not finite");
    return value;
}

double json_number(const JsonNode& node, double least, double most, const char* meaning) {
    const double value = json_number(node);
    if (!(value >= least && value <= most))
        node.fail(fmt::format("is {}, not {}", value, meaning), fmt::format("give {} to {}", least, most));
    return value;
}

bool json_flag(const JsonNode& node) {
    if (!node.value.is_boolean()) node.fail("is neither true nor false");
    return node.value.get<bool>();
}

const std::string& json_string(const JsonNode& node) {
    if (!node.value.is_string()) fail_type(node, "a string");
    return node.value.get_ref<const std::string&>();
}

void expect_array(const JsonNode& node, size_t size) {
    if (!node.value.is_array()) fail_type(node, "an array");
    if (node.value.size() != size) node.fail(fmt::format("has {} entries, not {}", node.value.size(), size));
}

void expect_list(const JsonNode& node) {
    if (!node.value.is_array()) fail_type(node, "an array");
    if (node.value.empty()) node.fail("is empty");
}

void expect_rigid(const JsonNode& node, const glm::dmat4& pose) {
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

glm::dmat4 json_pose(const JsonNode& node) {
    if (!node.value.is_array()) fail_type(node, "an array");
    const size_t rows = node.value.size();
    if (rows != 3 && rows != 4) node.fail(fmt::format("has {} rows", rows), "give 4×4 or 3×4 numbers, row by row");
    glm::dmat4 pose(1);
    for (size_t row = 0; row < rows; ++row) {
        expect_array(node[row], 4);
        for (size_t column = 0; column < 4; ++column)
            pose[static_cast<int>(column)][static_cast<int>(row)] = json_number(node[row][column]);
    }
    for (int column = 0; column < 4; ++column)
        if (std::abs(pose[column][3] - (column == 3 ? 1 : 0)) > kRigidTolerance)
            node[3].fail("is not 0 0 0 1", "give the matrix row by row, camera to world");
    expect_rigid(node, pose);
    return pose;
}

}  // namespace neuvv::training
