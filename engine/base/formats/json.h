// JSON that other programs wrote: values together with their place in the file, so that errors can say where a problem
// is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "base/error.h"

namespace neuvv {

// How errors write the place of a value.
enum class JsonPlaceStyle {
    kDotted,   // "frames[12].w"
    kPointer,  // "/frames/12/w"
};

// What errors say instead of what is wrong with a value: for files of the program itself, where such details do not
// help the reader.
struct JsonDamage {
    const char* problem;
    const char* fix;
};

// A value and its place. It refers to the document and to the file's name, which must outlive it. `Json` is
// nlohmann::json or nlohmann::ordered_json.
template <typename Json>
struct BasicJsonNode {
    const Json& value;
    const std::string& file;
    std::string place;
    JsonPlaceStyle style = JsonPlaceStyle::kDotted;
    const JsonDamage* damage = nullptr;

    // Throw InputError with the node's file and place.
    [[noreturn]] void fail(const std::string& problem, const Fix& fix = {}) const;
    [[noreturn]] void fail_type(const char* expected) const;  // "is a string, not {expected}"

    BasicJsonNode operator[](size_t i) const;         // i < size
    BasicJsonNode operator[](const char* key) const;  // throws InputError where it is missing
    bool has(const char* key) const { return value.contains(key); }
};
using JsonNode = BasicJsonNode<nlohmann::json>;
using OrderedJsonNode = BasicJsonNode<nlohmann::ordered_json>;

struct JsonFile {
    std::string name;
    nlohmann::json document;
    JsonNode root() const { return {document, name, ""}; }
};

// Reads a JSON file, which may contain comments. Throws InputError with the place of a syntax error, or where the
// document is no object; `expected` says what the file should be.
JsonFile read_json(const std::filesystem::path& file, const std::string& expected);
// The same of any document.
JsonFile read_json_value(const std::filesystem::path& file);

// All of these throw InputError where the value has another type.
template <typename Json>
double json_number(const BasicJsonNode<Json>& node);  // finite
template <typename Json>  // where the number is out of range, the error says that it is "not {meaning}"
double json_number(const BasicJsonNode<Json>& node, double min, double max, const char* meaning);
template <typename Json>
uint64_t json_count(const BasicJsonNode<Json>& node, uint64_t max);  // a whole number from 0 to max
template <typename Json>
bool json_flag(const BasicJsonNode<Json>& node);
template <typename Json>
const std::string& json_string(const BasicJsonNode<Json>& node);
template <typename Json>
void expect_array(const BasicJsonNode<Json>& node, size_t size);
template <typename Json>
void expect_list(const BasicJsonNode<Json>& node);  // an array with at least one entry

// An object whose members may be missing. A missing member leaves the output as it is; a wrong one throws InputError
// with its place, a JSON pointer.
struct JsonMembers : OrderedJsonNode {
    // Throws InputError where `object` is no object.
    JsonMembers(const nlohmann::ordered_json& object, const std::string& file_name, std::string json_place);

    const nlohmann::ordered_json* find(const char* name) const;
    void number(const char* name, double low, double high, double& number) const;
    void boolean(const char* name, bool& flag) const;
    void text(const char* name, std::string& text) const;
    // The index of the member's text in `names`, as the enum's value.
    template <typename Enum>
    void choice(const char* name, std::span<const char* const> names, Enum& result) const {
        result = static_cast<Enum>(choice_of(name, names, static_cast<size_t>(result)));
    }

  private:
    size_t choice_of(const char* name, std::span<const char* const> names, size_t fallback) const;
};

constexpr size_t kMaxQuoted = 120;  // characters of a file's text in an error

// Indented JSON with a line break at its end. Bytes that are not UTF-8, which file names may have, become U+FFFD.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace neuvv
