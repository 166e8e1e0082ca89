// The table: #name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2, a line for each image. Its conventions, of
// which the program's help has only parts:
// - Camera to world, OpenGL axes, +Z up: Rz(−heading) Rx(pitch) Ry(roll), in degrees. nerfstudio's
//   realitycapture_utils.py has the same, and it agrees in all digits with an XMP file that was exported of the same
//   camera ("Different rotation of cameras in XMP and CSV" in Epic's forum; the test has its numbers).
// - f is for a film of 36 mm along the image's longer side. px and py are parts of the longer side, from the image's
//   centre, as AliceVision and brush read them ("RealityCapture XMP Camera Math": image coordinates are −½ to ½).
// - k1, k2, k3 are Brown's radial terms r², r⁴, r⁶. Programs disagree about the order of t1 and t2, and no lens of
//   lens.h has a term r⁸ (k4), so these must be 0, as they are with RealityCapture's own choice, Brown3.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/error.h"
#include "interchange/camera/json_pose.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/camera_table.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

namespace {

constexpr double kFilm_mm = 36;
constexpr const char* kRequired[] = {"x", "y", "alt", "heading", "pitch", "roll", "f"};
constexpr const char* kOptional[] = {"px", "py", "k1", "k2", "k3", "k4", "t1", "t2"};
constexpr TableForm kForm{"#name", kRequired, kOptional, "export Internal/External camera parameters"};

Choice table_file(const std::filesystem::path& folder) {
    return newest_of(find_files_by_header(folder, ".csv", {"#name", "heading", "pitch", "roll"}));
}

glm::dmat3 turn(int axis, double degrees) {
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    glm::dmat3 result(1);
    result[next][next] = result[last][last] = c;
    result[next][last] = s;
    result[last][next] = -s;
    return result;
}

glm::dmat4 pose_of(const TableRow& row) {
    const auto at = [&](const char* column) { return row.values.at(column); };
    const glm::dmat3 axes =
        interchange::kYUpFromZUp * turn(2, -at("heading")) * turn(0, at("pitch")) * turn(1, at("roll"));
    return {glm::dvec4(axes[0], 0), glm::dvec4(axes[1], 0), glm::dvec4(axes[2], 0),
            glm::dvec4(interchange::kYUpFromZUp * glm::dvec3(at("x"), at("y"), at("alt")), 1)};
}

interchange::Lens lens_of(const TableRow& row, media::ImageSize size, const std::string& file) {
    const auto at = [&](const char* column) { return row.values.at(column); };
    for (const char* term : {"k4", "t1", "t2"})
        if (at(term) != 0)
            throw InputError(
                file, row.place, fmt::format("the camera {} has a distortion {}", row.name, term),
                "choose the distortion model Brown3 in RealityCapture's alignment settings, and align again");
    const double longer = std::max(size.width, size.height);
    interchange::Lens lens;
    lens.model = interchange::LensModel::kBrown;
    lens.fx = lens.fy = at("f") * longer / kFilm_mm;
    lens.cx = 0.5 * size.width + at("px") * longer;
    lens.cy = 0.5 * size.height + at("py") * longer;
    lens.k = {at("k1"), at("k2"), at("k3")};
    lens.width = size.width;
    lens.height = size.height;
    return lens;
}

}  // namespace

bool has_realitycapture_files(const std::filesystem::path& folder) {
    return !table_file(folder).path.empty();
}

Rig read_realitycapture_rig(const std::filesystem::path& folder, Split split) {
    const auto [path, remark] = table_file(folder);
    if (path.empty())
        throw InputError(folder.string(), "", "holds no table of RealityCapture's cameras",
                         "export Registration, Internal/External camera parameters, as .csv");
    Rig rig;
    rig.folder = folder;
    rig.format = "realitycapture";
    rig.images_as_stored = true;
    rig.file = path.string();
    if (!remark.empty()) rig.remarks.push_back(remark);
    rig.world = "metres where the project has a scale (ground control points, distances); +Y up, turned from +Z up";
    std::vector<CalibratedCamera> calibrated;
    std::map<std::string, TableRow> rows;  // by place
    for (TableRow& row : read_camera_table(path, kForm)) {
        RigCamera camera;
        camera.name = row.name;
        camera.world_from_camera = pose_of(row);
        calibrated.push_back({camera, row.place});
        rows.try_emplace(row.place, std::move(row));
    }
    std::vector<CameraFrames> cameras = find_images(rig, calibrated);
    for (CameraFrames& camera : cameras) {  // the table does not say how large images are
        ImageSource first = camera.frames.begin()->second;
        first.as_stored = rig.images_as_stored;
        camera.camera.lens = lens_of(rows.at(camera.place), size_of(first), rig.file);
        expect_sound(camera.camera, rig.file, camera.place);
    }
    add_cameras(rig, cameras, split);
    return rig;
}

}  // namespace neuvv::training
