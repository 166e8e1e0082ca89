#include "training/data/layouts/rig/holdout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/text.h"

namespace neuvv::training {

namespace {

// What may be given, where so many cameras can be held out.
std::string forms(size_t least, size_t most) {
    return fmt::format("give a number of cameras from {} to {}, a share (12.5%), or names (cam03,cam07)", least, most);
}

std::optional<double> number_in(std::string text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

// How many cameras are meant; nothing where the text is a name.
std::optional<size_t> count_of(const std::vector<std::string>& cameras, const std::string& holdout) {
    const bool percent = holdout.ends_with('%');
    const auto number = number_in(percent ? holdout.substr(0, holdout.size() - 1) : holdout);
    if (!number) return std::nullopt;
    const bool whole = !percent && holdout.find_first_not_of("0123456789") == std::string::npos;
    const bool names_one = std::ranges::find(cameras, holdout) != cameras.end();
    const auto all = static_cast<double>(cameras.size());
    if (whole && names_one && (*number > all || (holdout.size() > 1 && holdout[0] == '0'))) return std::nullopt;
    const double share = percent ? *number / 100 : *number;
    if (whole && *number > all)
        throw InputError(Setting{"holdout"}, holdout,
                         fmt::format("is more than the {} cameras that there are", cameras.size()),
                         forms(0, cameras.size()));
    if (!whole && !(share >= 0 && share < 1))
        throw InputError(Setting{"holdout"}, holdout, "is no share from 0 % to below 100 %", forms(0, cameras.size()));
    if (whole) return static_cast<size_t>(*number);
    return static_cast<size_t>(share > 0 ? std::max(1.0, std::round(share * all)) : 0);
}

// Whether the camera has this name, or is one of the images of that folder.
bool is_named(const std::string& camera, const std::string& name) {
    return camera == name || camera.starts_with(name + "/");
}

}  // namespace

std::vector<bool> held_out(const std::vector<std::string>& cameras, const std::string& holdout) {
    std::vector<bool> held(cameras.size());
    if (const std::optional<size_t> count = count_of(cameras, holdout)) {
        for (size_t i = 0; i < *count; ++i) held[i * cameras.size() / *count] = true;
        return held;
    }
    for (const std::string& name : split(holdout, ',')) {
        if (name.empty()) continue;
        bool found = false;
        for (size_t i = 0; i < cameras.size(); ++i)
            if (is_named(cameras[i], name)) held[i] = found = true;
        if (!found)
            throw InputError(Setting{"holdout"}, name, "is no camera",
                             fmt::format("the cameras are {:.500}", fmt::to_string(fmt::join(cameras, ", "))));
    }
    return held;
}

void select_split(Rig& rig, const std::string& holdout, Split wanted) {
    std::vector<std::string> names;
    for (const RigCamera& camera : rig.cameras) names.push_back(camera.name);
    const std::vector<bool> held = held_out(names, holdout);
    std::erase_if(rig.shots, [&](const Shot& shot) { return held[shot.camera] != (wanted == Split::kTest); });
    if (!rig.shots.empty()) return;
    const size_t most = names.size() - std::min<size_t>(1, names.size());
    if (wanted == Split::kTest)
        throw InputError(Setting{"holdout"}, holdout, "holds out no camera", forms(1, std::max<size_t>(1, most)));
    throw InputError(Setting{"holdout"}, holdout, "leaves no camera to train with", forms(0, most));
}

}  // namespace neuvv::training
