#include "training/data/layouts/rig/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/gtc/quaternion.hpp>

#include "base/error.h"
#include "base/text.h"
#include "interchange/camera/json_pose.h"
#include "media/image.h"
#include "media/video.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/layouts/rig/presentation.h"

namespace neuvv::training {

namespace {

constexpr double kMaxPixels = 1e7;  // of a focal length or a principal point
constexpr double kMaxDistortion = 1e6;
constexpr double kRotationTolerance = 1e-2;  // some files have three decimals

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

glm::dmat3 opencv_rotation(const std::vector<double>& numbers, const std::string& file, const std::string& place) {
    if (numbers.size() == 3) {
        const glm::dvec3 v(numbers[0], numbers[1], numbers[2]);
        const double angle = glm::length(v);
        if (!(angle < 1e3)) throw InputError(file, place, "is no rotation", "give its axis times its angle");
        return angle > 0 ? glm::mat3_cast(glm::angleAxis(angle, v / angle)) : glm::dmat3(1);
    }
    glm::dmat3 given(0);
    for (size_t i = 0; i < std::min<size_t>(numbers.size(), 9); ++i)
        given[static_cast<int>(i % 3)][static_cast<int>(i / 3)] = numbers[i];
    const glm::dmat3 rotation = glm::mat3_cast(glm::normalize(glm::quat_cast(given)));
    for (int i = 0; i < 3; ++i)
        if (!(glm::length(given[i] - rotation[i]) < kRotationTolerance))
            throw InputError(file, place, "is no rotation", "give 3×3 numbers, row by row");
    return rotation;
}

interchange::Lens opencv_lens(const std::vector<double>& matrix, const std::vector<double>& distortion, bool fisheye,
                              const std::string& file, const std::string& place) {
    const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6; };
    if (matrix.size() != 9 || !near(matrix[3], 0) || !near(matrix[6], 0) || !near(matrix[7], 0) || !near(matrix[8], 1))
        throw InputError(file, place, "is no camera matrix", "give fx 0 cx, 0 fy cy, 0 0 1");
    if (std::abs(matrix[1]) > kMaxSkew * std::abs(matrix[0]))
        throw InputError(file, place, fmt::format("has a skew of {:.4g}", matrix[1]), "calibrate without skew");
    const std::vector<double>& d = distortion;
    const size_t terms = fisheye ? 4 : 8;
    for (size_t i = terms; i < d.size(); ++i)
        if (d[i] != 0)
            throw InputError(file, place, fmt::format("has a distortion of more than {} terms", terms),
                             fisheye ? "give k1 k2 k3 k4" : "calibrate without thin prism and tilt");
    interchange::Lens lens;
    lens.fx = matrix[0];
    lens.fy = matrix[4];
    lens.cx = matrix[2] + 0.5;
    lens.cy = matrix[5] + 0.5;
    if (fisheye) {
        lens.model = interchange::LensModel::kFisheye;
        for (size_t i = 0; i < std::min(d.size(), terms); ++i) lens.k[i] = d[i];
    } else if (std::any_of(d.begin(), d.end(), [](double value) { return value != 0; })) {
        lens.model = interchange::LensModel::kBrown;
        const auto term = [&](size_t i) { return i < d.size() ? d[i] : 0; };
        lens.p1 = term(2);
        lens.p2 = term(3);
        lens.k = {term(0), term(1), term(4), term(5), term(6), term(7)};
    }
    return lens;
}

std::vector<double> json_numbers(const JsonNode& node, size_t count) {
    expect_list(node);
    std::vector<double> numbers;
    for (size_t i = 0; i < node.value.size() && numbers.size() <= count; ++i) {
        if (!node.value[i].is_array()) {
            numbers.push_back(json_number(node[i]));
            continue;
        }
        const JsonNode row = node[i];
        for (size_t j = 0; j < row.value.size() && numbers.size() <= count; ++j) numbers.push_back(json_number(row[j]));
    }
    if (numbers.size() != count) node.fail(fmt::format("does not have {} numbers", count));
    return numbers;
}

void fit_to_images(RigCamera& camera, ImageSource image, Rig& rig, const std::string& place) {
    const interchange::Lens& lens = camera.lens;
    image.as_stored = used_as_stored(image, lens, rig.images_as_stored);
    const media::ImageSize size = size_of(image);
    if (lens.width == 0 || (lens.width == size.width && lens.height == size.height)) return;
    const double across = static_cast<double>(size.width) / lens.width;
    const double down = static_cast<double>(size.height) / lens.height;
    // A scaled image has sides of whole pixels.
    const double rounding = 1.0 / std::min(size.width, lens.width) + 1.0 / std::min(size.height, lens.height);
    const bool as_shown = image.video_frame >= 0 && std::abs(across / down - 1) > rounding;
    const double aspect = as_shown ? media::VideoReader(image.path).pixel_aspect() : 1;
    if (std::abs(across / down * aspect - 1) <= rounding)
        camera.lens = scaled(lens, size.width, size.height);
    else if (!rig.misfit)
        rig.misfit = InputError(image.path.string(), "",
                                fmt::format("is {}×{}, but {} of {} says {}×{}, another shape", size.width, size.height,
                                            place, rig.file, lens.width, lens.height),
                                "give the images that the calibration is for, or scaled copies");
}

void expect_sound(const RigCamera& camera, const std::string& file, const std::string& place) {
    const interchange::Lens& lens = camera.lens;
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
        if (!within(camera.world_from_camera[3][i], interchange::kMaxDistance_m))
            throw InputError(file, place,
                             fmt::format("stands more than {:g} units from the origin", interchange::kMaxDistance_m),
                             "give metres, and no more digits than a GPS receiver has");
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

std::vector<std::filesystem::path> find_files_by_header(const std::filesystem::path& folder, const std::string& ending,
                                                        const std::vector<std::string>& texts) {
    constexpr size_t kHead = 4096;
    std::vector<std::filesystem::path> files = entries_of(folder);
    std::error_code ignored;
    std::erase_if(files, [&](const std::filesystem::path& file) {
        return !lower_case(file.filename().string()).ends_with(ending) ||
               !std::filesystem::is_regular_file(file, ignored);
    });
    std::erase_if(files, [&](const std::filesystem::path& file) {
        std::string header(1 + kHead, '\n');  // so that the file's first line is found as others are
        std::ifstream stream(file, std::ios::binary);
        stream.read(&header[1], kHead);
        header.resize(1 + static_cast<size_t>(stream.gcount()));
        if (header.compare(1, 3, "\xEF\xBB\xBF") == 0) header.erase(1, 3);  // a byte order mark
        return !std::ranges::all_of(texts,
                                    [&](const std::string& text) { return header.find(text) != std::string::npos; });
    });
    return files;
}

namespace {

Choice newest_in(const std::vector<std::filesystem::path>& folders, const std::string& ending,
                 const std::vector<std::string>& texts) {
    std::vector<std::filesystem::path> files;
    for (const auto& folder : folders)
        for (const auto& file : find_files_by_header(folder, ending, texts)) files.push_back(file);
    return newest_of(files);
}

}  // namespace

Choice newest_calibration(const std::filesystem::path& folder, const std::string& ending,
                          const std::vector<std::string>& texts) {
    return newest_in(calibration_folders(folder), ending, texts);
}

Choice session_calibration(const std::filesystem::path& folder, const std::string& ending,
                           const std::vector<std::string>& texts) {
    for (const auto& session : session_folders(folder))
        if (Choice found = newest_in(session, ending, texts); !found.path.empty()) return found;
    return {};
}

Choice calibration_of(const std::filesystem::path& folder, const std::string& ending,
                      const std::vector<std::string>& texts) {
    Choice own = newest_calibration(folder, ending, texts);
    return own.path.empty() ? session_calibration(folder, ending, texts) : own;
}

}  // namespace neuvv::training
