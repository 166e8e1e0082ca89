#include "tools/headset/draw/images.h"

#include <algorithm>
#include <vector>

namespace neuvv::headset {

std::filesystem::path next_image(const std::filesystem::path& folder, const std::filesystem::path& after) {
    std::vector<std::filesystem::path> images;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".png" && entry.is_regular_file(ignored)) images.push_back(entry.path());
    if (images.empty()) return {};
    std::sort(images.begin(), images.end());
    const auto next = std::upper_bound(images.begin(), images.end(), after);
    return next == images.end() ? images.front() : *next;
}

}  // namespace neuvv::headset
