// The conventions are those of Pose2Sim's calibration.py (toml_write), which took them from anipose (aniposelib):
// a table for each camera, with name, size [w, h], matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], distortions k1 k2 p1
// p2 (k3), or k1 … k4 where fisheye is true, rotation (Rodrigues' vector) and translation, all as OpenCV has them:
// x_camera = R x_world + T. Pose2Sim has metres, and a world with +Z up; the table `metadata` is no camera.
// Caliscope's camera_array.toml has the same numbers in tables [cameras.0], [cameras.1] … (its older config.toml in
// [cam_0] …, with 3×3 rotations), metres and +Z up; its videos are cam_0.mp4 … or port_0.mp4 …. It keeps cameras that
// are not calibrated yet, and those that its user leaves out (`ignore`).
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/platform.h"
#include "base/text.h"
#include "interchange/camera/json_pose.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxTomlBytes = uint64_t{4} << 20;

constexpr const char* kTomlEnding = ".toml";
const std::vector<std::string> kTomlTexts = {"distortions", "rotation", "translation"};

// The table of a camera.
struct TomlCamera {
    const std::string& file;
    const std::string key;
    const toml::table& table;

    [[noreturn]] void fail(const std::string& name, const std::string& problem, const std::string& fix = "") const {
        const toml::node* node = table.get(name);
        const auto line = (node ? node->source() : table.source()).begin.line;
        throw InputError(file, fmt::format("[{:.80}] {}, line {}", key, name, line), problem, fix);
    }
    std::string place() const { return fmt::format("[{:.80}]", key); }

    // The numbers of an array, or of an array of arrays row by row; there are `least` to `most`.
    std::vector<double> numbers(const std::string& name, size_t least, size_t most) const {
        const toml::node* node = table.get(name);
        if (!node || !node->is_array()) fail(name, "is no array of numbers", "calibrate the camera again");
        std::vector<double> values;
        gather(*node->as_array(), name, values);
        if (values.size() < least || values.size() > most) fail(name, fmt::format("has {} numbers", values.size()));
        return values;
    }

  private:
    void gather(const toml::array& array, const std::string& name, std::vector<double>& values) const {
        for (const toml::node& node : array) {
            if (const toml::array* row = node.as_array()) {
                gather(*row, name, values);
                continue;
            }
            const std::optional<double> value = node.value<double>();
            if (!value || !std::isfinite(*value)) fail(name, "has an entry that is no number");
            values.push_back(*value);
        }
    }
};

uint32_t whole_side(const TomlCamera& camera, double side) {
    if (!(side >= 1 && side <= media::kMaxImageSide))
        camera.fail("size", fmt::format("has a side of {:g}", side), "give the images' size in pixels");
    return static_cast<uint32_t>(std::lround(side));
}

CalibratedCamera camera_of(const TomlCamera& from) {
    CalibratedCamera result{{}, from.place()};
    RigCamera& camera = result.camera;
    camera.name = without_extension(portable_name(from.table["name"].value_or(from.key)));
    expect_inside(camera.name, from.file, from.place());
    camera.lens = opencv_lens(from.numbers("matrix", 9, 9), from.numbers("distortions", 0, 8),
                              from.table["fisheye"].value_or(false), from.file, from.place());
    const std::vector<double> size = from.numbers("size", 2, 2), t = from.numbers("translation", 3, 3);
    camera.lens.width = whole_side(from, size[0]);
    camera.lens.height = whole_side(from, size[1]);
    const glm::dmat3 rotation = opencv_rotation(from.numbers("rotation", 3, 9), from.file, from.place());
    camera.world_from_camera = glm::dmat4(interchange::kYUpFromZUp) * world_from_opencv(rotation, {t[0], t[1], t[2]});
    expect_sound(camera, from.file, from.place());
    return result;
}

// Caliscope numbers its cameras and names their videos in one of two ways.
std::string caliscope_name(const std::filesystem::path& folder, const std::string& number) {
    const std::string port = "port_" + number;
    return has_images(folder, port) ? port : "cam_" + number;
}

// A camera that Caliscope has not calibrated, or that its user left out there.
bool is_left_out(const toml::table& table) {
    return table["ignore"].value_or(false) || (table.contains("port") && !table.contains("rotation")) ||
           (table.contains("cam_id") && !table.contains("rotation"));
}

using TomlCameras = std::map<std::string, CalibratedCamera, NaturalOrder>;

// Adds the cameras among the tables of `parent`, which is the root, or Caliscope's `cameras`.
void gather_cameras(Rig& rig, const toml::table& parent, bool caliscope, TomlCameras& cameras) {
    std::string left_out;
    for (const auto& [key, node] : parent) {
        const std::string name(key.str());
        const toml::table* table = node.as_table();
        if (table && (caliscope || table->contains("matrix"))) {
            if (is_left_out(*table)) {
                left_out += " " + name;
                continue;
            }
            CalibratedCamera camera = camera_of({rig.file, caliscope ? "cameras." + name : name, *table});
            if (caliscope) camera.camera.name = caliscope_name(rig.folder, name);
            if (!caliscope && table->contains("port") && !table->contains("name") && name.starts_with("cam_"))
                camera.camera.name = caliscope_name(rig.folder, name.substr(4));
            cameras.try_emplace(name, std::move(camera));
        }
    }
    if (!left_out.empty()) rig.remarks.push_back("Caliscope ignores or has not calibrated the cameras" + left_out);
}

std::vector<CalibratedCamera> read_cameras(Rig& rig) {
    const std::string& file = rig.file;
    const std::vector<uint8_t> bytes = read_file(file, kMaxTomlBytes);
    TomlCameras cameras;
    try {
        const toml::table root =
            toml::parse(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
        const toml::table* nested = root["cameras"].as_table();
        if (nested) rig.world = "metres, as Caliscope has them; +Y up, turned from +Z up";
        gather_cameras(rig, nested ? *nested : root, nested != nullptr, cameras);
    } catch (const toml::parse_error& error) {
        throw InputError(file, fmt::format("line {}", error.source().begin.line),
                         fmt::format("is no TOML: {:.200}", error.description()));
    }
    if (cameras.empty())
        throw InputError(file, "", "has no camera", "calibrate the cameras in the program that wrote it");
    std::vector<CalibratedCamera> result;
    for (auto& [key, camera] : cameras) result.push_back(std::move(camera));
    return result;
}

}  // namespace

bool has_pose2sim_files(const std::filesystem::path& folder) {
    return !newest_calibration(folder, kTomlEnding, kTomlTexts).path.empty();
}

bool has_pose2sim_session(const std::filesystem::path& folder) {
    return !session_calibration(folder, kTomlEnding, kTomlTexts).path.empty();
}

Rig read_pose2sim_rig(const std::filesystem::path& folder, Split split) {
    const auto [path, remark] = calibration_of(folder, kTomlEnding, kTomlTexts);
    if (path.empty())
        throw InputError(folder.string(), "", "holds no Calib.toml, and neither does its folder calibration/",
                         "calibrate the cameras in Pose2Sim, anipose or Caliscope");
    Rig rig;
    rig.folder = folder;
    rig.format = "pose2sim";
    rig.file = path.string();
    rig.world = "metres, as Pose2Sim has them (anipose: the unit of its board); +Y up, turned from +Z up";
    if (!remark.empty()) rig.remarks.push_back(remark);
    add_cameras(rig, find_images(rig, read_cameras(rig)), split);
    return rig;
}

}  // namespace neuvv::training
