#include "tools/headset/draw/pictures.h"

#include <algorithm>
#include <vector>

namespace neuvv::headset {

std::filesystem::path next_picture(const std::filesystem::path& folder, const std::filesystem::path& after) {
    std::vector<std::filesystem::path> pictures;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".png" && entry.is_regular_file(ignored)) pictures.push_back(entry.path());
    if (pictures.empty()) return {};
    std::sort(pictures.begin(), pictures.end());
    const auto next = std::upper_bound(pictures.begin(), pictures.end(), after);
    return next == pictures.end() ? pictures.front() : *next;
}

}  // namespace neuvv::headset
