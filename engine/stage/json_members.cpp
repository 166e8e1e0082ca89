#include "stage/json_members.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"

namespace neuvv::stage {

namespace {
constexpr double kMaxColor = 1e6;
}

JsonMembers::JsonMembers(const nlohmann::ordered_json& object, const std::string& file_name, std::string json_place)
    : json(object), file(file_name), place(std::move(json_place)) {
    if (!json.is_object()) throw InputError(file, place, "is not an object");
}

void JsonMembers::fail(const char* name, const std::string& problem) const {
    throw InputError(file, place + "/" + name, problem);
}

const nlohmann::ordered_json* JsonMembers::find(const char* name) const {
    const auto found = json.find(name);
    return found == json.end() ? nullptr : &*found;
}

void JsonMembers::number(const char* name, double low, double high, double& value) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return;
    const double given = found->is_number() ? found->get<double>() : NAN;
    if (!(given >= low && given <= high)) fail(name, fmt::format("is no number from {} to {}", low, high));
    value = given;
}

void JsonMembers::boolean(const char* name, bool& value) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return;
    if (!found->is_boolean()) fail(name, "is neither true nor false");
    value = found->get<bool>();
}

void JsonMembers::text(const char* name, std::string& value) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return;
    if (!found->is_string()) fail(name, "is not a string");
    value = found->get<std::string>();
}

void JsonMembers::color(const char* name, glm::dvec3& value) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return;
    const bool whole = found->is_array() && found->size() == 3;
    for (int i = 0; i < 3; ++i) {
        const auto channel = static_cast<size_t>(i);
        const double given = whole && (*found)[channel].is_number() ? (*found)[channel].get<double>() : NAN;
        if (!(given >= 0 && given <= kMaxColor)) fail(name, "is not three numbers from 0, linear red, green and blue");
        value[i] = given;
    }
}

size_t JsonMembers::choice_of(const char* name, std::span<const char* const> names, size_t otherwise) const {
    const nlohmann::ordered_json* found = find(name);
    if (!found) return otherwise;
    std::string all;
    for (size_t i = 0; i < names.size(); ++i) {
        if (found->is_string() && found->get_ref<const std::string&>() == names[i]) return i;
        all += (i ? ", " : "") + std::string(names[i]);
    }
    fail(name, "is none of " + all);
}

}  // namespace neuvv::stage
