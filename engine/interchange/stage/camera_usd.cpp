#include "interchange/stage/camera_usd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "base/error.h"
#include "base/output_path.h"
#include "interchange/usd/usd_writer.h"
#include "interchange/usd/usd_xform.h"
#include "stage/camera_path_json.h"

namespace neuvv::interchange {

namespace {

// Lenses are told in tenths of the file's unit, the metre: the sensor is as high as that of 35 mm film. Only the ratio
// of the two counts for images.
constexpr double kSensorHeight = 0.24;
constexpr double kDefaultFocalLength = 50, kDefaultAperture_x = 20.955, kDefaultAperture_y = 15.2908;  // OpenUSD's

// The prims from the root of the file to a prim; empty where there is none.
using UsdPrims = std::vector<const UsdPrim*>;

UsdPrims find_camera(const std::vector<UsdPrim>& prims) {
    for (const UsdPrim& prim : prims) {
        if (prim.specifier != "def") continue;
        const auto projection = prim.attributes.find("projection");
        const bool flat = projection != prim.attributes.end() && !projection->second.value.texts.empty() &&
                          projection->second.value.texts[0] != "perspective";
        if (prim.type == "Camera" && !flat) return {&prim};
        if (UsdPrims below = find_camera(prim.children); !below.empty()) {
            below.insert(below.begin(), &prim);
            return below;
        }
    }
    return {};
}

std::vector<double> time_codes_of(const UsdPrims& prims, double start) {
    std::set<double> codes = {start};
    for (const UsdPrim* prim : prims)
        for (const auto& [name, attribute] : prim->attributes)
            if (prim == prims.back() || name.starts_with("xformOp:"))
                for (const auto& [time, value] : attribute.samples)
                    if (time > start) codes.insert(time);
    return {codes.begin(), codes.end()};
}

class UsdCamera {
  public:
    UsdCamera(const UsdLayer& layer, const UsdPrims& prims, const std::string& file)
        : world_from_layer_(usd_world_from_layer(layer, file)), prims_(prims), file_(file) {}
    stage::CameraPathKey key_at(double time_code) const;

  private:
    double number(const char* name, double fallback, double time_code) const;

    glm::dmat4 world_from_layer_;
    const UsdPrims& prims_;
    const std::string& file_;
};

double UsdCamera::number(const char* name, double fallback, double time_code) const {
    const auto found = prims_.back()->attributes.find(name);
    if (found == prims_.back()->attributes.end()) return fallback;
    const UsdValue value = usd_value_at(found->second, time_code);
    return value.numbers.empty() ? fallback : value.numbers[0];
}

stage::CameraPathKey UsdCamera::key_at(double time_code) const {
    glm::dmat4 pose(1);
    for (const UsdPrim* prim : prims_) {
        if (usd_resets_stack(*prim)) pose = glm::dmat4(1);
        pose *= usd_local_transform(*prim, time_code, file_);
    }
    pose = world_from_layer_ * pose;
    stage::CameraPathKey key;
    key.position = glm::dvec3(pose[3]);
    glm::dmat3 axes(pose);
    // A camera may be scaled, which its images do not show.
    for (int i = 0; i < 3; ++i) axes[i] /= glm::length(axes[i]);
    const std::string place = prims_.back()->name;
    if (!(std::abs(glm::determinant(axes) - 1) < 1e-3))
        throw InputError(file_, place, fmt::format("is sheared, flat or mirrored at the time code {:g}", time_code));
    if (!(glm::length(key.position) < 1e9)) throw InputError(file_, place, "is more than 1e9 m from the origin");
    key.world_from_camera = glm::normalize(glm::quat_cast(axes));
    const double focal = number("focalLength", kDefaultFocalLength, time_code),
                 width = number("horizontalAperture", kDefaultAperture_x, time_code),
                 height = number("verticalAperture", kDefaultAperture_y, time_code);
    key.angle_y = 2 * std::atan2(0.5 * height, focal);
    if (!(focal > 0 && width > 0 && height > 0 && key.angle_y >= stage::kMinPathAngle_rad &&
          key.angle_y <= stage::kMaxPathAngle_rad))
        throw InputError(file_, place,
                         fmt::format("has no lens: focal length {:g}, sensor {:g} by {:g}", focal, width, height));
    // Both are of the lens's whole sensor. Images of another shape keep the height, as OpenUSD's `verticalAperture`.
    key.shift = {-number("horizontalApertureOffset", 0, time_code) / height,
                 number("verticalApertureOffset", 0, time_code) / height};
    if (!(glm::length(key.shift) < 100)) throw InputError(file_, place, "has a lens that is shifted off the image");
    return key;
}

}  // namespace

std::string usd_camera_prim(const std::string& name, const stage::CameraPath& images, const std::string& indent) {
    const double aspect = static_cast<double>(images.width) / images.height;
    using Key = stage::CameraPathKey;
    std::string text = fmt::format(
        "{0}def Camera \"{1}\"\n{0}{{\n{0}    float2 clippingRange = (0.05, 10000)\n"
        "{0}    token projection = \"perspective\"\n",
        indent, name);
    const auto add = [&](const char* attribute, const std::function<std::string(const Key&)>& value) {
        std::vector<std::string> values;
        for (const Key& key : images.keys) values.push_back(value(key));
        append_usd_values(text, indent + "    ", attribute, values);
    };
    const auto add_number = [&](const char* attribute, const std::function<double(const Key&)>& number) {
        add(attribute, [&](const Key& key) { return fmt::format("{:.9g}", number(key)); });
    };
    add_number("float focalLength", [](const Key& key) { return 0.5 * kSensorHeight / std::tan(0.5 * key.angle_y); });
    add_number("float horizontalAperture", [&](const Key& key) { return kSensorHeight * aspect / key.stretch; });
    add_number("float verticalAperture", [](const Key&) { return kSensorHeight; });
    // The offset moves the window through which the lens looks; the principal point moves the other way.
    add_number("float horizontalApertureOffset",
               [](const Key& key) { return -key.shift.x * kSensorHeight / key.stretch; });
    add_number("float verticalApertureOffset", [](const Key& key) { return key.shift.y * kSensorHeight; });
    add("double3 xformOp:translate", [](const Key& key) {
        return fmt::format("({:.12g}, {:.12g}, {:.12g})", key.position.x, key.position.y, key.position.z);
    });
    add("quatd xformOp:orient", [](const Key& key) {
        const glm::dquat& q = key.world_from_camera;
        return fmt::format("({:.12g}, {:.12g}, {:.12g}, {:.12g})", q.w, q.x, q.y, q.z);
    });
    return text + fmt::format(
                      "{0}    uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]\n"
                      "{0}}}\n",
                      indent);
}

void write_camera_usda(const std::filesystem::path& file, const stage::CameraPath& images) {
    write_text_file(file,
                    fmt::format("#usda 1.0\n(\n    defaultPrim = \"Camera\"\n    metersPerUnit = 1\n"
                                "    upAxis = \"Y\"\n    startTimeCode = 0\n    endTimeCode = {}\n"
                                "    timeCodesPerSecond = {:.9g}\n    framesPerSecond = {:.9g}\n)\n\n{}",
                                images.keys.size() - 1, images.fps, images.fps, usd_camera_prim("Camera", images, "")));
}

stage::CameraPath read_camera_usda(const std::filesystem::path& file) {
    const UsdLayer layer = read_usda(file);
    const std::string name = file.string();
    const UsdPrims prims = find_camera(layer.prims);
    if (prims.empty())
        throw InputError(name, "", "has no perspective camera of its own",
                         "references are not followed: flatten it with usdcat --flatten");
    const double per_second = layer.number("timeCodesPerSecond", 24);
    if (!(per_second >= 1e-3 && per_second <= 1e6))
        throw InputError(name, "timeCodesPerSecond", fmt::format("is {}", per_second));
    double first = INFINITY;
    for (const UsdPrim* prim : prims)
        for (const auto& [attribute, value] : prim->attributes)
            if (!value.samples.empty()) first = std::min(first, value.samples[0].first);
    const double start = layer.number("startTimeCode", std::isfinite(first) ? first : 0);
    if (!std::isfinite(start)) throw InputError(name, "startTimeCode", "is no number");
    stage::CameraPath path;
    path.interpolation = stage::Interpolation::kLinear;
    const UsdCamera camera(layer, prims, name);
    for (const double code : time_codes_of(prims, start)) {
        if (path.keys.size() >= stage::kMaxPathKeys)
            throw InputError(name, "", fmt::format("has more than {} time samples", stage::kMaxPathKeys));
        stage::CameraPathKey key = camera.key_at(code);
        key.time_s = (code - start) / per_second;
        if (!path.keys.empty() && !(key.time_s > path.keys.back().time_s))
            throw InputError(name, "", "has time samples too close to tell apart");
        path.keys.push_back(key);
    }
    path.duration_s = path.keys.back().time_s;
    return path;
}

}  // namespace neuvv::interchange
