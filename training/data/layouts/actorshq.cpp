// The conventions are those of ActorsHQ's own loader (github.com/synthesiaresearch/humanrf, actorshq/dataset):
// - calibration.csv: x_world = R x_camera + t, R of the vector rx ry rz (axis times angle), in metres; the camera has
//   OpenCV's axes (camera_data.py). fx and px are parts of the width, fy and py of the height.
// - Rays leave through pixels' middles at +½ (ray_sampler.cu), so px · w is counted from the image's corner.
// - +Y is up: toolbox/export_ngp.py turns y to instant-ngp's z.
// - Images are rgbs/Cam001/Cam001_rgb000000.jpg, with a black background; masks masks/Cam001/Cam001_mask000000.png.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/camera_table.h"
#include "training/data/layouts/rig/candidates.h"

namespace neuvv::training {

namespace {

constexpr const char* kColumns[] = {"w", "h", "rx", "ry", "rz", "tx", "ty", "tz", "fx", "fy", "px", "py"};
constexpr TableForm kActorsTable{"name", kColumns, {}, "give ActorsHQ's calibration.csv"};

Choice calibration_table(const std::filesystem::path& folder) {
    return newest_of(find_files_by_header(folder, ".csv", {"\nname", "rx", "ry", "rz", "fx", "px"}));
}

uint32_t side_of(const TableRow& row, const char* column, const std::string& file) {
    const double side = row.values.at(column);
    if (!(side >= 1 && side <= media::kMaxImageSide && side == std::floor(side)))
        throw InputError(file, fmt::format("{}, {}", row.place, column), fmt::format("is {:g}", side),
                         "give the images' size in pixels");
    return static_cast<uint32_t>(side);
}

CalibratedCamera camera_in_row(const TableRow& row, const std::string& file) {
    const auto at = [&](const char* column) { return row.values.at(column); };
    CalibratedCamera result{{}, row.place};
    RigCamera& camera = result.camera;
    camera.name = row.name;
    camera.lens.width = side_of(row, "w", file);
    camera.lens.height = side_of(row, "h", file);
    camera.lens.fx = at("fx") * camera.lens.width;
    camera.lens.fy = at("fy") * camera.lens.height;
    camera.lens.cx = at("px") * camera.lens.width;
    camera.lens.cy = at("py") * camera.lens.height;
    const glm::dmat3 camera_from_world =
        glm::transpose(opencv_rotation({at("rx"), at("ry"), at("rz")}, file, row.place));
    camera.world_from_camera =
        world_from_opencv(camera_from_world, -(camera_from_world * glm::dvec3(at("tx"), at("ty"), at("tz"))));
    expect_sound(camera, file, row.place);
    return result;
}

}  // namespace

bool has_actorshq_files(const std::filesystem::path& folder) {
    return !calibration_table(folder).path.empty();
}

Rig read_actorshq_rig(const std::filesystem::path& folder, Split split) {
    const auto [path, remark] = calibration_table(folder);
    if (path.empty())
        throw InputError(folder.string(), "", "holds no calibration.csv of ActorsHQ",
                         "name the folder of one scale, 1x, 2x or 4x");
    Rig rig;
    rig.folder = folder;
    rig.format = "actorshq";
    rig.file = path.string();
    rig.world = "metres, +Y up";
    if (!remark.empty()) rig.remarks.push_back(remark);
    std::vector<CalibratedCamera> calibrated;
    for (const TableRow& row : read_camera_table(path, kActorsTable))
        calibrated.push_back(camera_in_row(row, rig.file));
    add_cameras(rig, find_images(rig, calibrated), split);
    return rig;
}

}  // namespace neuvv::training
