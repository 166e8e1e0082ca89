// JSON that other programs wrote: values that know where they stand, so that whatever is wrong with them can be named.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace neuvv::training {

// A value and where it stands, for errors. Refers to the document, which must outlive it.
struct JsonNode {
    const nlohmann::json& value;
    const std::string& file;
    std::string place;  // "frames[12].w"

    [[noreturn]] void fail(const std::string& problem, const std::string& mend = "") const;
    JsonNode operator[](size_t i) const;
    JsonNode operator[](const char* key) const;  // which it has()
    bool has(const char* key) const { return value.contains(key); }
};

struct JsonFile {
    std::string name;
    nlohmann::json document;
    JsonNode root() const { return {document, name, ""}; }
};

// Comments are allowed. Throws InputError with the place where the JSON ends to be such, or for a document that is no
// object; `expected` says what the file should be.
JsonFile read_json(const std::filesystem::path& file, const std::string& expected);

// All of these throw InputError where the value is of another type.
double json_number(const JsonNode& node);                                                  // finite
double json_number(const JsonNode& node, double least, double most, const char* meaning);  // "not {meaning}"
bool json_flag(const JsonNode& node);
const std::string& json_string(const JsonNode& node);
void expect_array(const JsonNode& node, size_t size);
void expect_list(const JsonNode& node);  // an array with at least one entry

// A camera's pose in rows, 4×4 or 3×4: rigid, right-handed, not out of this world.
glm::dmat4 json_pose(const JsonNode& node);
void expect_rigid(const JsonNode& node, const glm::dmat4& pose);

// (x, y, z) → (x, z, −y)
inline const glm::dmat3 kYUpFromZUp(1, 0, 0, 0, 0, -1, 0, 1, 0);

constexpr size_t kMaxQuoted = 120;      // of a file's own text, in an error
constexpr double kMaxDistance_m = 1e6;  // beyond it, floats no longer resolve a performer

}  // namespace neuvv::training
