#include "training/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "media/image.h"

namespace neuvv::training {

namespace {

constexpr double kMaxDistance = 1e6;  // metres; further away, floats do not resolve a performer
constexpr double kMaxPixels = 1e7;    // of a focal length or a principal point
constexpr double kMaxDistortion = 1e6;

bool within(double value, double limit) {
    return std::abs(value) <= limit;  // false for NaN
}

}  // namespace

glm::dmat4 world_from_opencv(const glm::dmat3& rotation, const glm::dvec3& translation) {
    const glm::dmat3 world_from_axes = glm::transpose(rotation);
    const glm::dvec3 centre = -(world_from_axes * translation);
    return {glm::dvec4(world_from_axes[0], 0), glm::dvec4(-world_from_axes[1], 0), glm::dvec4(-world_from_axes[2], 0),
            glm::dvec4(centre, 1)};
}

void expect_sound(const RigCamera& camera, const std::string& file, const std::string& place) {
    const Lens& lens = camera.lens;
    if (!(lens.fx > 0 && lens.fy > 0) || !within(lens.fx, kMaxPixels) || !within(lens.fy, kMaxPixels))
        throw InputError(file, place, fmt::format("has the focal lengths {:.6g} and {:.6g}", lens.fx, lens.fy),
                         "give them in pixels");
    if (!within(lens.cx, kMaxPixels) || !within(lens.cy, kMaxPixels))
        throw InputError(file, place, fmt::format("has the principal point {:.6g}, {:.6g}", lens.cx, lens.cy),
                         "give it in pixels from the top left corner");
    const bool straight = std::all_of(lens.k.begin(), lens.k.end(), [](double k) { return within(k, kMaxDistortion); });
    if (!straight || !within(lens.p1, kMaxDistortion) || !within(lens.p2, kMaxDistortion) ||
        !within(lens.s1, kMaxDistortion) || !within(lens.s2, kMaxDistortion))
        throw InputError(file, place, "has a distortion that no lens has", "calibrate again");
    if ((lens.width == 0) != (lens.height == 0) || std::max(lens.width, lens.height) > media::kMaxImageSide)
        throw InputError(file, place, fmt::format("is for images of {}×{}", lens.width, lens.height),
                         fmt::format("a side has 1 to {} pixels", media::kMaxImageSide));
    for (int i = 0; i < 3; ++i)
        if (!within(camera.world_from_camera[3][i], kMaxDistance))
            throw InputError(file, place, fmt::format("stands more than {} m from the origin", kMaxDistance),
                             "give metres");
}

void expect_inside(const std::string& name, const std::string& file, const std::string& place) {
    const std::filesystem::path path(name);
    const bool parts_sound =
        std::none_of(path.begin(), path.end(), [](const auto& part) { return part == ".." || part == "."; });
    const bool printable =
        std::none_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
    constexpr size_t kLongest = 1024;
    if (name.empty() || name.size() > kLongest || path.is_absolute() || !path.has_filename() || !parts_sound ||
        !printable)
        throw InputError(file, place, fmt::format("\"{:.80}\" is no name within the data set's folder", name),
                         "a data set reads nothing outside its folder");
}

}  // namespace neuvv::training
