// Preference files: JSON objects that a program keeps between runs, that users may edit, and that newer programs may
// have written. Nothing in such a file is an error: a member that cannot be understood gets its default, and a message
// tells the user. This is the only header of the module that names JSON; only the two sources that map preferences to
// JSON include it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace neuvv::editor {

// Reads members that may be missing or of any type, and records the wrong ones in `wrong`: by `place`, which says where
// the object is in the file, and name.
struct PreferenceReader {
    std::vector<std::string> wrong;

    // The member, or null where it is missing or `object` is no object.
    static const nlohmann::ordered_json* find(const nlohmann::ordered_json& object, const char* name);
    // The member, or an empty object where it is missing or no object.
    const nlohmann::ordered_json& object(const nlohmann::ordered_json& parent, const char* name);
    void boolean(const nlohmann::ordered_json& object, const std::string& place, const char* name, bool& value);
    // Reads a text of at most kMaxText bytes without zeros, which would end a C string in the middle. Returns whether
    // it was sound.
    bool text(const nlohmann::ordered_json& json, const std::string& place, std::string& value);
    // Reads a number from low to high. Returns whether it was there and sound.
    template <typename Number>
    bool number(const nlohmann::ordered_json& object, const std::string& place, const char* name, Number low,
                Number high, Number& value) {
        double read = 0;
        if (!find_number(object, place, name, static_cast<double>(low), static_cast<double>(high), read)) return false;
        value = static_cast<Number>(read);
        return true;
    }

    static constexpr size_t kMaxText = 4096;

  private:
    bool find_number(const nlohmann::ordered_json& object, const std::string& place, const char* name, double low,
                     double high, double& value);
};

struct PreferenceFile {
    // Empty where the file is missing or cannot be read.
    nlohmann::ordered_json document = nlohmann::ordered_json::object();
    std::string message;  // a line for the user about what was wrong; empty: nothing was
};
// Never throws because of what the file contains.
PreferenceFile load_preference_file(const std::filesystem::path& path);
// The message about wrong members: "PATH: not understood, so defaults are used: window.width". Empty where `wrong` is
// empty.
std::string wrong_members(const std::filesystem::path& path, const std::vector<std::string>& wrong);

// Writes the file atomically, and makes its folder where that is missing. Throws RuntimeFailure.
void save_preference_file(const std::filesystem::path& path, const nlohmann::ordered_json& document);
// The member, to be written to. Where it is missing or no object, it becomes an empty object.
nlohmann::ordered_json& object_in(nlohmann::ordered_json& parent, const std::string& name);

}  // namespace neuvv::editor
