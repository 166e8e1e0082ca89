#include "base/formats/json.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

namespace {

using json = nlohmann::json;

constexpr uint64_t kMaxJsonBytes = uint64_t{256} << 20;

// Parses a file that is no valid JSON, to find the place of the error.
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
            if (text.size() > kMaxQuoted) break;  // for a file of many brackets
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

}  // namespace

template <typename Json>
void BasicJsonNode<Json>::fail(const std::string& problem, const Fix& fix) const {
    if (damage) throw InputError(file, place, damage->problem, damage->fix);
    throw InputError(file, place, problem, fix);
}

template <typename Json>
void BasicJsonNode<Json>::fail_type(const char* expected) const {
    fail(fmt::format("is a {}, not {}", value.type_name(), expected));
}

template <typename Json>
BasicJsonNode<Json> BasicJsonNode<Json>::operator[](size_t i) const {
    std::string at =
        style == JsonPlaceStyle::kDotted ? fmt::format("{}[{}]", place, i) : fmt::format("{}/{}", place, i);
    return {value[i], file, std::move(at), style, damage};
}

template <typename Json>
BasicJsonNode<Json> BasicJsonNode<Json>::operator[](const char* key) const {
    std::string at = style == JsonPlaceStyle::kPointer ? place + "/" + key : place.empty() ? key : place + "." + key;
    if (!has(key)) BasicJsonNode{value, file, std::move(at), style, damage}.fail("is missing");
    return {value[key], file, std::move(at), style, damage};
}

JsonFile read_json_value(const std::filesystem::path& file) {
    JsonFile result{file.string(), {}};
    result.document = parse(result.name, read_file(file, kMaxJsonBytes));
    return result;
}

JsonFile read_json(const std::filesystem::path& file, const std::string& expected) {
    JsonFile result = read_json_value(file);
    if (!result.document.is_object()) result.root().fail("is not a JSON object", "give " + expected);
    return result;
}

template <typename Json>
double json_number(const BasicJsonNode<Json>& node) {
    if (!node.value.is_number()) node.fail_type("a number");
    const double value = node.value.template get<double>();
    if (!std::isfinite(value)) node.fail("is not finite");
    return value;
}

template <typename Json>
double json_number(const BasicJsonNode<Json>& node, double min, double max, const char* meaning) {
    const double value = json_number(node);
    if (!(value >= min && value <= max))
        node.fail(fmt::format("is {}, not {}", value, meaning), fmt::format("give {} to {}", min, max));
    return value;
}

template <typename Json>
uint64_t json_count(const BasicJsonNode<Json>& node, uint64_t max) {
    if (!node.value.is_number_unsigned()) node.fail_type("a whole number");
    const auto value = node.value.template get<uint64_t>();
    if (value > max) node.fail(fmt::format("is {}, more than {}", value, max));
    return value;
}

template <typename Json>
bool json_flag(const BasicJsonNode<Json>& node) {
    if (!node.value.is_boolean()) node.fail("is neither true nor false");
    return node.value.template get<bool>();
}

template <typename Json>
const std::string& json_string(const BasicJsonNode<Json>& node) {
    if (!node.value.is_string()) node.fail_type("a string");
    return node.value.template get_ref<const std::string&>();
}

template <typename Json>
void expect_array(const BasicJsonNode<Json>& node, size_t size) {
    if (!node.value.is_array()) node.fail_type("an array");
    if (node.value.size() != size) node.fail(fmt::format("has {} entries, not {}", node.value.size(), size));
}

template <typename Json>
void expect_list(const BasicJsonNode<Json>& node) {
    if (!node.value.is_array()) node.fail_type("an array");
    if (node.value.empty()) node.fail("is empty");
}

#define NEUVV_READ_JSON(Json)                                                             \
    template struct BasicJsonNode<Json>;                                                  \
    template double json_number(const BasicJsonNode<Json>&);                              \
    template double json_number(const BasicJsonNode<Json>&, double, double, const char*); \
    template uint64_t json_count(const BasicJsonNode<Json>&, uint64_t);                   \
    template bool json_flag(const BasicJsonNode<Json>&);                                  \
    template const std::string& json_string(const BasicJsonNode<Json>&);                  \
    template void expect_array(const BasicJsonNode<Json>&, size_t);                       \
    template void expect_list(const BasicJsonNode<Json>&);
NEUVV_READ_JSON(nlohmann::json)
NEUVV_READ_JSON(nlohmann::ordered_json)
#undef NEUVV_READ_JSON

JsonMembers::JsonMembers(const nlohmann::ordered_json& object, const std::string& file_name, std::string json_place)
    : OrderedJsonNode{object, file_name, std::move(json_place), JsonPlaceStyle::kPointer} {
    if (!value.is_object()) fail("is not an object");
}

const nlohmann::ordered_json* JsonMembers::find(const char* name) const {
    const auto found = value.find(name);
    return found == value.end() ? nullptr : &*found;
}

void JsonMembers::number(const char* name, double low, double high, double& number) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return;
    const double given = found->is_number() ? found->get<double>() : NAN;
    if (!(given >= low && given <= high)) (*this)[name].fail(fmt::format("is no number from {} to {}", low, high));
    number = given;
}

void JsonMembers::boolean(const char* name, bool& flag) const {
    if (has(name)) flag = json_flag((*this)[name]);
}

void JsonMembers::text(const char* name, std::string& text) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return;
    if (!found->is_string()) (*this)[name].fail("is not a string");
    text = found->get<std::string>();
}

size_t JsonMembers::choice_of(const char* name, std::span<const char* const> names, size_t fallback) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return fallback;
    std::string all;
    for (size_t i = 0; i < names.size(); ++i) {
        if (found->is_string() && found->get_ref<const std::string&>() == names[i]) return i;
        all += (i ? ", " : "") + std::string(names[i]);
    }
    (*this)[name].fail("is none of " + all);
}

std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace neuvv
