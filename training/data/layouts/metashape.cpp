// The conventions are those of "Camera models" in the Metashape manual's appendix, and of nerfstudio's
// metashape_utils.py:
// - A camera's transform is 4×4 numbers, row by row, from the camera (OpenCV axes) to its component, whose transform
//   goes on to the chunk's world: x ↦ scale · rotation · x + translation, in metres.
// - x = X/Z, y = Y/Z, r² = x² + y²:
//   x' = x (1 + K1 r² + K2 r⁴ + K3 r⁶ + K4 r⁸) + P1 (r² + 2 x²) + 2 P2 x y
//   y' = y (1 + K1 r² + K2 r⁴ + K3 r⁶ + K4 r⁸) + P2 (r² + 2 y²) + 2 P1 x y
//   u = w/2 + cx + x' f + x' B1 + y' B2, v = h/2 + cy + y' f, in pixels whose centres are at +½.
//   So P1 is OpenCV's p2 and P2 its p1. A fisheye has θ/r · x and θ/r · y in place of x and y.
// - A slave of a multi-camera system stands at its master's transform times (rotation, location) of its own sensor,
//   which take OpenCV axes of the slave to those of the master.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "interchange/camera/json_pose.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/xml_file.h"

namespace neuvv::training {

namespace {

constexpr double kEarthScale_m = 1e6;  // geocentric positions are six times as far from the origin

Choice metashape_file(const std::filesystem::path& folder) {
    return newest_of(find_files_by_header(folder, ".xml", {"<document", "<chunk"}));
}

double number_of(const XmlNode& calibration, const char* name, double fallback = 0) {
    const auto found = calibration.find(name);
    return found ? found->numbers(1)[0] : fallback;
}

uint32_t metashape_side(const XmlNode& resolution, const char* name) {
    const double side = resolution.number(name);
    if (!(side >= 1 && side <= media::kMaxImageSide && side == std::floor(side)))
        resolution.fail(fmt::format("has a {} of {}", name, side), "give the images' size in pixels");
    return static_cast<uint32_t>(side);
}

interchange::Lens metashape_lens(const XmlNode& calibration) {
    const std::string type = calibration.text("type", "frame");
    const bool fisheye = type == "fisheye" || type == "equidistant_fisheye";
    if (type != "frame" && !fisheye)
        calibration.fail(fmt::format("is of the type {:.40}, which is not modelled", type),
                         "export undistorted images and their cameras from Metashape");
    interchange::Lens lens;
    const XmlNode resolution = calibration.child("resolution");
    lens.width = metashape_side(resolution, "width");
    lens.height = metashape_side(resolution, "height");
    const double f = calibration.child("f").numbers(1)[0], skew = number_of(calibration, "b2");
    if (std::abs(skew) > kMaxSkew * std::abs(f))
        calibration.fail(fmt::format("has a skew b2 of {:.4g} pixels", skew), "optimise in Metashape without b2");
    for (const char* term : {"p3", "p4"})
        if (number_of(calibration, term) != 0)
            calibration.fail(fmt::format("has a {}, which is not modelled", term),
                             "optimise in Metashape without p3 and p4");
    lens.fx = f + number_of(calibration, "b1");
    lens.fy = f;
    lens.cx = 0.5 * lens.width + number_of(calibration, "cx");
    lens.cy = 0.5 * lens.height + number_of(calibration, "cy");
    lens.k = {number_of(calibration, "k1"), number_of(calibration, "k2"), number_of(calibration, "k3")};
    lens.p1 = number_of(calibration, "p2");
    lens.p2 = number_of(calibration, "p1");
    const double k4 = number_of(calibration, "k4");
    if (fisheye)
        lens.k[3] = k4;
    else if (k4 != 0)
        calibration.fail("has a k4, and only fisheye lenses are modelled with four radial terms",
                         "optimise in Metashape without k4, or export undistorted images");
    lens.model = fisheye ? interchange::LensModel::kFisheye : interchange::LensModel::kBrown;
    return lens;
}

// The lens of a sensor: what Metashape adjusted, rather than what it was given.
interchange::Lens read_sensor(const XmlNode& sensor) {
    const std::vector<XmlNode> calibrations = sensor.children("calibration");
    if (calibrations.empty()) sensor.fail("has no calibration", "align the photos in Metashape");
    const XmlNode* chosen = &calibrations[0];
    for (const XmlNode& calibration : calibrations)
        if (calibration.text("class") == "adjusted") chosen = &calibration;
    return metashape_lens({chosen->element, sensor.file});
}

// A world in metres from the coordinates in which cameras are given: x ↦ scale · rotation · x + translation.
struct Similarity {
    glm::dmat3 rotation{1};
    glm::dvec3 translation{0};
    double scale = 1;
};

std::optional<Similarity> read_similarity(const XmlNode& owner) {
    const auto transform = owner.find("transform");
    if (!transform) return {};
    Similarity result;
    if (const auto rotation = transform->find("rotation"))
        result.rotation = opencv_rotation(rotation->numbers(9), owner.file, rotation->place());
    if (const auto translation = transform->find("translation")) {
        const std::vector<double> t = translation->numbers(3);
        result.translation = {t[0], t[1], t[2]};
    }
    if (const auto scale = transform->find("scale")) result.scale = scale->numbers(1)[0];
    if (!(result.scale > 1 / interchange::kMaxDistance_m && result.scale < interchange::kMaxDistance_m))
        transform->fail("has no scale");
    return result;
}

// The camera's pose in its component, with OpenGL axes.
glm::dmat4 metashape_pose(const XmlNode& transform) {
    const std::vector<double> m = transform.numbers(16);
    const std::vector<double> axes = {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
    const glm::dmat3 from_camera = opencv_rotation(axes, transform.file, transform.place());
    return {glm::dvec4(from_camera[0], 0), glm::dvec4(-from_camera[1], 0), glm::dvec4(-from_camera[2], 0),
            glm::dvec4(m[3], m[7], m[11], 1)};
}

// The pose of a slave in its master, both with OpenGL axes: x_master = rotation · x_slave + location in OpenCV's, in
// the chunk's unit, as the master's transform.
glm::dmat4 in_rig(const XmlNode& rotation, const XmlNode& location) {
    const glm::dmat3 turn = opencv_rotation(rotation.numbers(9), rotation.file, rotation.place());
    const std::vector<double> at = location.numbers(3);
    const glm::dmat3 flip(1, 0, 0, 0, -1, 0, 0, 0, -1);
    glm::dmat4 result(flip * turn * flip);
    result[3] = glm::dvec4(flip * glm::dvec3(at[0], at[1], at[2]), 1);
    return result;
}

glm::dmat4 placed(const Similarity& world, const glm::dmat4& pose) {
    glm::dmat4 result;
    for (int i = 0; i < 3; ++i) result[i] = glm::dvec4(world.rotation * glm::dvec3(pose[i]), 0);
    result[3] = glm::dvec4(world.scale * (world.rotation * glm::dvec3(pose[3])) + world.translation, 1);
    return result;
}

// All cameras of a chunk, those in groups included.
void gather_cameras(const XmlNode& parent, std::vector<XmlNode>& cameras) {
    for (const XmlNode& camera : parent.children("camera")) cameras.push_back(camera);
    for (const XmlNode& group : parent.children("group")) gather_cameras(group, cameras);
}

// What the cameras of a chunk refer to.
struct Chunk {
    std::map<std::string, XmlNode> sensors;
    std::map<std::string, std::optional<Similarity>> components;
    std::optional<Similarity> transform;
    bool has_local_coordinates = false;  // by its reference, else they may be geocentric
};

Chunk read_chunk(const XmlNode& node) {
    Chunk chunk;
    for (const XmlNode& sensor : node.child("sensors").children("sensor"))
        chunk.sensors.try_emplace(sensor.text("id"), sensor);
    if (const auto components = node.find("components"))
        for (const XmlNode& component : components->children("component"))
            chunk.components.try_emplace(component.text("id"), read_similarity(component));
    chunk.transform = read_similarity(node);
    const auto reference = node.find("reference");
    const char* system = reference ? reference->element->GetText() : nullptr;
    chunk.has_local_coordinates = system && std::string(system).find("LOCAL_CS") != std::string::npos;
    return chunk;
}

class Cameras {
  public:
    Cameras(Rig& rig, const XmlNode& node) : rig_(rig), chunk_(read_chunk(node)) {
        std::vector<XmlNode> all;
        gather_cameras(node.child("cameras"), all);
        for (const XmlNode& camera : all)
            if (is_enabled(camera)) by_id_.try_emplace(camera.text("id"), camera);
        for (const XmlNode& camera : all) add(camera);
        if (found_.empty()) node.fail("has no camera with a pose", "align the photos in Metashape");
        describe(all.size());
    }
    const std::vector<CalibratedCamera>& found() const { return found_; }

  private:
    static bool is_enabled(const XmlNode& node) {
        const std::string enabled = node.text("enabled", "true");
        return enabled != "false" && enabled != "0";
    }

    const XmlNode& sensor_of(const XmlNode& node) const {
        const auto sensor = chunk_.sensors.find(node.text("sensor_id"));
        if (sensor == chunk_.sensors.end()) node.fail("has a sensor_id that no sensor has", "export the cameras again");
        return sensor->second;
    }

    // A camera of a multi-camera system has no transform of its own where it is a slave: the master's is followed by
    // the place of the slave's sensor in the system. Nothing where the camera is not aligned.
    std::optional<glm::dmat4> pose_of(const XmlNode& node) {
        if (const auto transform = node.find("transform")) return metashape_pose(*transform);
        const std::string id = node.text("master_id");
        if (id.empty() || id == node.text("id")) return {};
        const auto master = by_id_.find(id);
        if (master == by_id_.end())
            node.fail(fmt::format("is placed by the camera {:.40}, which is missing or disabled", id),
                      "export the cameras again, the masters of multi-camera systems included");
        const auto transform = master->second.find("transform");
        if (!transform) return {};
        const XmlNode& sensor = sensor_of(node);
        const auto rotation = sensor.find("rotation");
        const auto location = sensor.find(sensor.find("location") ? "location" : "translation");
        if (!rotation || !location || node.text("sensor_id") == master->second.text("sensor_id"))
            node.fail(fmt::format("belongs to a multi-camera system (master_id {:.40}), and neither it has a transform "
                                  "nor its sensor a rotation and a location",
                                  id),
                      "in Metashape, align with the offsets of the slaves adjusted, or export without the "
                      "multi-camera layout");
        ++placed_by_rig_;
        return metashape_pose(*transform) * in_rig(*rotation, *location);
    }

    void add(const XmlNode& node) {
        if (!is_enabled(node)) return;
        const std::optional<glm::dmat4> pose = pose_of(node);
        if (!pose) return;
        CalibratedCamera camera;
        camera.place = node.place();
        camera.camera.name = without_extension(portable_name(node.text("label")));
        camera.camera.lens = read_sensor(sensor_of(node));
        camera.camera.world_from_camera = *pose;
        place_in_world(node, camera.camera.world_from_camera);
        expect_sound(camera.camera, rig_.file, camera.place);
        found_.push_back(std::move(camera));
    }

    void place_in_world(const XmlNode& node, glm::dmat4& pose) {
        const auto component = chunk_.components.find(node.text("component_id"));
        const bool known = component != chunk_.components.end(), alone = chunk_.components.size() < 2;
        if (!known && !alone) node.fail("has a component_id that no component has", "export the cameras again");
        const std::optional<Similarity>& world =
            known && (component->second || !alone) ? component->second : chunk_.transform;
        components_.insert(node.text("component_id"));
        if (found_.empty()) placed_ = world.has_value();
        if (world.has_value() != placed_ || (!placed_ && components_.size() > 1))
            node.fail("is of another component than the cameras before it, whose place in it is not known",
                      "merge the components in Metashape, or disable the cameras of all but one");
        if (!world) return;
        pose = placed(*world, pose);
        const bool geocentric = !chunk_.has_local_coordinates && glm::length(glm::dvec3(pose[3])) > kEarthScale_m;
        if (found_.empty()) geocentric_ = geocentric;
        if (geocentric != geocentric_)
            node.fail("stands on the earth where cameras before it stand at its centre, or the reverse",
                      "choose Local Coordinates in the chunk's reference settings, and export again");
        if (!geocentric) pose = glm::dmat4(interchange::kYUpFromZUp) * pose;
    }

    void describe(size_t cameras) {
        rig_.world = geocentric_ ? "metres; geocentric axes (ECEF), so that no axis is up: for +Z up, choose Local "
                                   "Coordinates in the chunk's reference settings, and export again"
                     : placed_   ? "metres; +Y up, turned from Metashape's +Z up"
                                 : "Metashape's own unit and axes, as the chunk has no reference: set a scale bar and "
                                   "markers there, else the way up and the size are arbitrary";
        if (found_.size() < cameras)
            rig_.remarks.push_back(
                fmt::format("{} of {} cameras of Metashape are disabled or not aligned, and are left out",
                            cameras - found_.size(), cameras));
        if (placed_by_rig_ > 0)
            rig_.remarks.push_back(
                fmt::format("{} cameras of multi-camera systems stand where their master's pose and "
                            "the rotation and location of their sensor put them",
                            placed_by_rig_));
    }

    Rig& rig_;
    const Chunk chunk_;
    std::vector<CalibratedCamera> found_;
    std::map<std::string, XmlNode> by_id_;  // the enabled cameras
    size_t placed_by_rig_ = 0;
    std::set<std::string> components_;
    bool geocentric_ = false;  // whether they are in coordinates of the whole earth
    bool placed_ = false;      // whether the cameras' place in a world in metres is known
};

}  // namespace

bool has_metashape_files(const std::filesystem::path& folder) {
    return !metashape_file(folder).path.empty();
}

Rig read_metashape_rig(const std::filesystem::path& folder, Split split) {
    const auto [path, remark] = metashape_file(folder);
    if (path.empty())
        throw InputError(folder.string(), "", "holds no cameras of Metashape",
                         "in Metashape, choose File, Export, Export Cameras, and Agisoft XML");
    const XmlFile file(path);
    Rig rig;
    rig.folder = folder;
    rig.format = "metashape";
    rig.images_as_stored = true;
    rig.file = path.string();
    if (!remark.empty()) rig.remarks.push_back(remark);
    const std::vector<XmlNode> chunks = file.root().children("chunk");
    if (chunks.size() != 1)
        file.root().fail(fmt::format("has {} chunks", chunks.size()), "export the cameras of one chunk");
    const Cameras cameras(rig, chunks[0]);
    add_cameras(rig, find_images(rig, cameras.found()), split);
    return rig;
}

}  // namespace neuvv::training
