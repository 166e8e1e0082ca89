// The conventions are those of CMU's panoptic-toolbox (python/panutils.py, README.md, scripts/): K, distCoef (k1 k2 p1
// p2 k3), R and t are OpenCV's, x_camera = R x_world + t. t is in centimetres, and −Y is up: of the skeleton in the
// toolbox's README, the neck has y = −147, the ankles −8. Videos are hdVideos/hd_00_00.mp4, their images
// hdImgs/00_00/00_00_00000000.jpg. Cameras of one type run in step, at 29.97 (hd) or 25 frames a second (vga), so
// frames of two types that have one number are not of one time.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/formats/json.h"
#include "interchange/camera/json_pose.h"
#include "media/image.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"

namespace neuvv::training {

namespace {

constexpr double kMetre_cm = 100;
constexpr std::pair<const char*, double> kRates[] = {{"hd", 29.97}, {"vga", 25}};  // frames a second by type

Choice panoptic_file(const std::filesystem::path& folder) {
    return newest_of(find_files_by_header(folder, ".json", {"\"cameras\"", "\"distCoef\""}));
}

std::string panoptic_name(const JsonNode& node) {
    std::string name = without_extension(portable_name(json_string(node["name"])));
    expect_inside(name, node.file, node.place);
    return name;
}

CalibratedCamera panoptic_camera(const JsonNode& node) {
    CalibratedCamera result{{}, node.place};
    RigCamera& camera = result.camera;
    camera.name = panoptic_name(node);
    const JsonNode k = node["K"], size = node["resolution"];
    std::vector<double> distortion;
    if (node.has("distCoef")) distortion = json_numbers(node["distCoef"], 5);
    camera.lens = opencv_lens(json_numbers(k, 9), distortion, false, node.file, k.place);
    expect_array(size, 2);
    camera.lens.width = static_cast<uint32_t>(json_count(size[size_t{0}], media::kMaxImageSide));
    camera.lens.height = static_cast<uint32_t>(json_count(size[size_t{1}], media::kMaxImageSide));
    const std::vector<double> t = json_numbers(node["t"], 3);
    const glm::dmat3 rotation = opencv_rotation(json_numbers(node["R"], 9), node.file, node["R"].place);
    camera.world_from_camera =
        glm::dmat4(interchange::kYUpFromYDown) * world_from_opencv(rotation, glm::dvec3(t[0], t[1], t[2]) / kMetre_cm);
    expect_sound(camera, node.file, node.place);
    return result;
}

// The cameras of the first type that has images, in the order hd, vga, others. rig.remarks says which others have some.
std::vector<CalibratedCamera> of_one_type(Rig& rig, const JsonNode& cameras) {
    std::map<std::string, std::vector<JsonNode>> types;
    std::vector<std::string> order, with_images;
    for (const auto& [type, rate] : kRates) order.emplace_back(type);
    for (size_t i = 0; i < cameras.value.size(); ++i) {
        const JsonNode camera = cameras[i];
        const std::string type = camera.has("type") ? json_string(camera["type"]) : "";
        types[type].push_back(camera);
        if (std::ranges::find(order, type) == order.end()) order.push_back(type);
    }
    for (const std::string& type : order)
        if (std::ranges::any_of(types[type],
                                [&](const JsonNode& node) { return has_images(rig.folder, panoptic_name(node)); }))
            with_images.push_back(type);
    // Where none has images of its name, cameras may be taken in order.
    const std::string chosen =
        !with_images.empty()
            ? with_images[0]
            : *std::ranges::find_if(order, [&](const std::string& type) { return !types[type].empty(); });
    for (const auto& [type, rate] : kRates)
        if (chosen == type) rig.fps = rate;
    if (with_images.size() > 1)
        rig.remarks.push_back("cameras of the type " +
                              choice_remark(chosen, {with_images.begin() + 1, with_images.end()}) +
                              ": frames of another type are of other times");
    std::vector<CalibratedCamera> result;
    for (const JsonNode& node : types[chosen]) result.push_back(panoptic_camera(node));
    return result;
}

}  // namespace

bool has_panoptic_files(const std::filesystem::path& folder) {
    return !panoptic_file(folder).path.empty();
}

Rig read_panoptic_rig(const std::filesystem::path& folder, Split split) {
    const auto [path, remark] = panoptic_file(folder);
    if (path.empty())
        throw InputError(folder.string(), "", "holds no calibration of Panoptic Studio",
                         "put the sequence's calibration_NAME.json there");
    const JsonFile file = read_json(path, "a calibration of Panoptic Studio");
    Rig rig;
    rig.folder = folder;
    rig.format = "panoptic";
    rig.images_as_stored = true;
    rig.file = file.name;
    rig.world = "metres, from centimetres; +Y up, turned from −Y up";
    if (!remark.empty()) rig.remarks.push_back(remark);
    const JsonNode cameras = file.root()["cameras"];
    expect_list(cameras);
    const std::vector<CalibratedCamera> calibrated = of_one_type(rig, cameras);
    add_cameras(rig, find_images(rig, calibrated), split);
    return rig;
}

}  // namespace neuvv::training
