// The conventions are those of Pose2Sim's calibration.py (calib_qca_fun) and calib_toml_to_qca.py, but for distortion:
// - transform: x, y, z is the camera's position in millimetres. r11 r12 r13, r21 … are the rows of the rotation from
//   the world, which has +Z up, to the camera, whose axes are OpenGL's.
// - intrinsic: focal lengths and centre are in 1/64 pixels of the whole sensor, counted from the corner of its first
//   pixel (sensorMaxU is 64 · 1920 − 1). A video of binned pixels has fewer of them, which the ratio of the sensor's
//   and the video's size says; a cropped one begins at fov_video's left and top.
// - radialDistortion1 … 3, tangentalDistortion1, 2 (sic) are OpenCV's k1, k2, k3, p1, p2. Pose2Sim divides them by 64,
//   too, and multiplies them where it writes a file itself; those of Qualisys have the size that lenses have undivided.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "interchange/camera/json_pose.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/xml_file.h"

namespace neuvv::training {

namespace {

constexpr double kSubpixels = 64;
constexpr double kMaxBinning = 8, kBinningTolerance = 0.01;
constexpr double kMetres_mm = 1000;
constexpr double kSmallestRig_mm = 50;  // cameras within so few units of the origin are given in metres

constexpr const char* kQcaEnding = ".qca.txt";
const std::vector<std::string> kQcaTexts = {"<calibration"};

// The pixels from first to last.
double extent(const XmlNode& node, const char* first, const char* last) {
    const double size = node.number(last) - node.number(first) + 1;
    if (!(size >= 1 && size <= kSubpixels * kMaxBinning * media::kMaxImageSide))
        node.fail(fmt::format("has {} to {} that are no size", first, last), "export the calibration again");
    return size;
}

// How many units of the intrinsics a pixel of the video has: 64 times the pixels that are binned into it.
double units_per_pixel(const XmlNode& intrinsic, const XmlNode& whole_video) {
    if (!intrinsic.has("sensorMaxU")) return kSubpixels;
    const double ratio =
        extent(intrinsic, "sensorMinU", "sensorMaxU") / extent(whole_video, "left", "right") / kSubpixels;
    const double binning = std::round(ratio);
    if (!(binning >= 1 && binning <= kMaxBinning && std::abs(ratio / binning - 1) < kBinningTolerance))
        intrinsic.fail(fmt::format("has a sensor of {:.4g} units for a pixel of the video", ratio * kSubpixels),
                       "give Qualisys' own file, in which a pixel has 64");
    return kSubpixels * binning;
}

interchange::Lens video_lens(const XmlNode& camera, double distortion_units) {
    const XmlNode intrinsic = camera.child("intrinsic"), video = camera.child("fov_video");
    const double unit = units_per_pixel(intrinsic, camera.find("fov_video_max").value_or(video));
    interchange::Lens lens;
    lens.fx = intrinsic.number("focalLengthU") / unit;
    lens.fy = intrinsic.number("focalLengthV") / unit;
    lens.cx = intrinsic.number("centerPointU") / unit - video.number("left");
    lens.cy = intrinsic.number("centerPointV") / unit - video.number("top");
    const double skew = intrinsic.number("skew", 0) / unit;
    if (std::abs(skew) > kMaxSkew * std::abs(lens.fx))
        intrinsic.fail(fmt::format("has a skew of {:.4g} pixels", skew), "linearise the camera without skew");
    const auto distortion = [&](const char* name) { return intrinsic.number(name, 0) / distortion_units; };
    lens.model = interchange::LensModel::kBrown;
    lens.k = {distortion("radialDistortion1"), distortion("radialDistortion2"), distortion("radialDistortion3")};
    lens.p1 = distortion("tangentalDistortion1");
    lens.p2 = distortion("tangentalDistortion2");
    lens.width = static_cast<uint32_t>(extent(video, "left", "right"));
    lens.height = static_cast<uint32_t>(extent(video, "top", "bottom"));
    return lens;
}

glm::dvec3 qca_position(const XmlNode& transform) {
    return {transform.number("x"), transform.number("y"), transform.number("z")};
}

glm::dmat4 qca_pose(const XmlNode& transform, double metre) {
    std::vector<double> numbers;
    for (const char* name : {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"})
        numbers.push_back(transform.number(name));
    const glm::dmat3 axes =
        interchange::kYUpFromZUp * glm::transpose(opencv_rotation(numbers, transform.file, transform.place()));
    return {glm::dvec4(axes[0], 0), glm::dvec4(axes[1], 0), glm::dvec4(axes[2], 0),
            glm::dvec4(interchange::kYUpFromZUp * qca_position(transform) / metre, 1)};
}

// How many units of the positions a metre has.
double units_per_metre(const std::vector<XmlNode>& cameras) {
    for (const XmlNode& camera : cameras)
        if (glm::length(qca_position(camera.child("transform"))) > kSmallestRig_mm) return kMetres_mm;
    return 1;
}

// The cameras with videos by their names, in natural order, as Pose2Sim takes them.
std::multimap<std::string, XmlNode, NaturalOrder> video_cameras(const XmlNode& root) {
    std::multimap<std::string, XmlNode, NaturalOrder> cameras;
    for (const XmlNode& node : root.child("cameras").children("camera"))
        if (node.find("fov_video")) cameras.emplace(node.text("serial"), node);
    return cameras;
}

// Gives a camera that has images its lens and its pose.
void calibrate(CalibratedCamera& camera, const XmlNode& node, double metre, double distortion_units, Rig& rig) {
    camera.camera.lens = video_lens(node, distortion_units);
    camera.camera.world_from_camera = qca_pose(node.child("transform"), metre);
    expect_sound(camera.camera, rig.file, camera.place);
    if (node.number("viewrotation", 0) != 0)
        rig.remarks.push_back(fmt::format("the camera {} has a viewrotation: its video must be as the sensor saw it",
                                          camera.camera.name));
}

}  // namespace

bool has_qualisys_files(const std::filesystem::path& folder) {
    return !newest_calibration(folder, kQcaEnding, kQcaTexts).path.empty();
}

bool has_qualisys_session(const std::filesystem::path& folder) {
    return !session_calibration(folder, kQcaEnding, kQcaTexts).path.empty();
}

Rig read_qualisys_rig(const std::filesystem::path& folder, Split split) {
    const auto [path, remark] = calibration_of(folder, kQcaEnding, kQcaTexts);
    if (path.empty())
        throw InputError(folder.string(), "", "holds no calibration of Qualisys, NAME.qca.txt",
                         "export it from Qualisys Track Manager");
    const XmlFile file(path);
    const XmlNode root = file.root();
    Rig rig;
    rig.folder = folder;
    rig.format = "qualisys";
    rig.file = path.string();
    if (!remark.empty()) rig.remarks.push_back(remark);
    std::vector<CalibratedCamera> calibrated;
    std::vector<XmlNode> nodes, used;  // used: those with images, as cameras that see only markers are in the file, too
    for (const auto& [name, node] : video_cameras(root)) {
        CalibratedCamera& camera = calibrated.emplace_back(CalibratedCamera{{}, node.place()});
        camera.camera.name = name;
        nodes.push_back(node);
    }
    pair_by_order(rig, calibrated);
    for (size_t i = 0; i < nodes.size(); ++i)
        if (has_images(folder, calibrated[i].camera.name)) used.push_back(nodes[i]);
    const double metre = units_per_metre(used), distortion_units = root.text("qtm-version") == "none" ? kSubpixels : 1;
    rig.world = fmt::format("metres, from {}; +Y up, turned from +Z up", metre > 1 ? "millimetres" : "metres");
    auto node = used.begin();
    for (CalibratedCamera& camera : calibrated)
        if (has_images(folder, camera.camera.name)) calibrate(camera, *node++, metre, distortion_units, rig);
    add_cameras(rig, find_images(rig, calibrated), split);
    return rig;
}

}  // namespace neuvv::training
