#include "training/data/layouts/rig/camera_names.h"

#include <algorithm>
#include <set>

namespace neuvv::training {

namespace {

// The beginning that all names have in common, up to its last separator; of a single name, all of it.
std::string common_name(const std::vector<std::string>& names) {
    if (names.empty()) return "";
    if (names.size() == 1) return names[0];
    size_t length = names[0].size();
    for (const std::string& name : names) {
        const auto end = names[0].begin() + static_cast<ptrdiff_t>(length);
        length = static_cast<size_t>(std::mismatch(names[0].begin(), end, name.begin(), name.end()).first -
                                     names[0].begin());
    }
    const size_t separator = names[0].substr(0, length).find_last_of("_-./ ");
    return separator == std::string::npos ? "" : names[0].substr(0, separator);
}

}  // namespace

std::optional<std::vector<std::string>> names_by_images(
    const std::vector<std::vector<std::string>>& images_of_cameras) {
    std::vector<std::string> names;
    std::set<std::string> distinct{""};  // with "", so that no name may be empty
    for (const auto& images : images_of_cameras) {
        names.push_back(common_name(images));
        if (!distinct.insert(names.back()).second) return std::nullopt;
    }
    return names;
}

}  // namespace neuvv::training
