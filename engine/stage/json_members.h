// Inside of this room only: members of an extension's object, read with their types and ranges checked.
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace neuvv::stage {

// Of one object. A missing member leaves `value` as it is; a wrong one throws InputError at its place.
struct JsonMembers {
    const nlohmann::ordered_json& json;
    const std::string& file;
    std::string place;

    // Throws where `json` is no object.
    JsonMembers(const nlohmann::ordered_json& object, const std::string& file_name, std::string json_place);

    const nlohmann::ordered_json* find(const char* name) const;
    void number(const char* name, double low, double high, double& value) const;
    void boolean(const char* name, bool& value) const;
    void text(const char* name, std::string& value) const;
    void color(const char* name, glm::dvec3& value) const;  // three numbers from 0
    // The index of the text among `names`.
    template <typename Enum>
    void choice(const char* name, std::span<const char* const> names, Enum& value) const {
        value = static_cast<Enum>(choice_of(name, names, static_cast<size_t>(value)));
    }

  private:
    size_t choice_of(const char* name, std::span<const char* const> names, size_t otherwise) const;
    [[noreturn]] void fail(const char* name, const std::string& problem) const;
};

}  // namespace neuvv::stage
