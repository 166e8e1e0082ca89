// Files of what a program remembers between runs: JSON objects that users may edit, and that newer programs may have
// written. Nothing in such a file is an error: a member that cannot be understood has its default, and the user is
// told. The one header of this module that names JSON: only the two sources that map preferences to it include it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace neuvv::editor {

// Reads members that may be missing or anything, and remembers which were wrong, by `place` and name.
struct PreferenceReader {
    std::vector<std::string> wrong;

    // The member, if it is there; what is not an object has none.
    static const nlohmann::ordered_json* find(const nlohmann::ordered_json& object, const char* name);
    // Empty where it is missing or no object.
    const nlohmann::ordered_json& object(const nlohmann::ordered_json& parent, const char* name);
    void boolean(const nlohmann::ordered_json& object, const std::string& place, const char* name, bool& value);
    // Short enough, and without zeros, which would end it in the middle.
    bool text(const nlohmann::ordered_json& json, const std::string& place, std::string& value);
    // Within low..high. Whether it was there and sound.
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
    nlohmann::ordered_json document = nlohmann::ordered_json::object();  // empty where there is none that can be read
    std::string message;  // one line for the user about what was wrong; empty: nothing
};
// Never throws for what is there.
PreferenceFile load_preference_file(const std::filesystem::path& path);
// "…: not understood, so defaults are used: window.width"; empty where nothing was wrong.
std::string wrong_members(const std::filesystem::path& path, const std::vector<std::string>& wrong);

// Atomically, its folder made where it is missing. Throws RuntimeFailure.
void save_preference_file(const std::filesystem::path& path, const nlohmann::ordered_json& document);
// The member as an object to write into, over what stood there.
nlohmann::ordered_json& object_in(nlohmann::ordered_json& parent, const std::string& name);

}  // namespace neuvv::editor
