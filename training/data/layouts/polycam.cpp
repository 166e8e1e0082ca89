// The conventions are those of nerfstudio's polycam_utils.py: t_00 … t_23 are the rows of a matrix from the camera
// (OpenGL axes) to a world in metres with +Y up, ARKit's, which nerfstudio turns to +Z up. keyframes/corrected_cameras
// belong to keyframes/corrected_images, whose lens is undone, and keyframes/cameras to keyframes/images.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/formats/json.h"
#include "interchange/camera/json_pose.h"
#include "media/image.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

namespace {

// Folders of the cameras and of their images; the corrected ones come first.
constexpr std::pair<const char*, const char*> kPolycamFolders[] = {
    {"keyframes/corrected_cameras", "keyframes/corrected_images"}, {"keyframes/cameras", "keyframes/images"}};

RigCamera polycam_camera(const JsonNode& root, const std::string& name) {
    RigCamera camera;
    camera.name = name;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            camera.world_from_camera[column][row] = json_number(root[fmt::format("t_{}{}", row, column).c_str()]);
    interchange::expect_rigid(root, camera.world_from_camera);
    camera.lens.fx = json_number(root["fx"]);
    camera.lens.fy = json_number(root["fy"]);
    camera.lens.cx = json_number(root["cx"]);
    camera.lens.cy = json_number(root["cy"]);
    camera.lens.width = static_cast<uint32_t>(json_count(root["width"], media::kMaxImageSide));
    camera.lens.height = static_cast<uint32_t>(json_count(root["height"], media::kMaxImageSide));
    expect_sound(camera, root.file, "fx");
    return camera;
}

}  // namespace

bool has_polycam_files(const std::filesystem::path& folder) {
    for (const auto& [cameras, images] : kPolycamFolders)
        if (!find_files_by_header(folder / cameras, ".json", {"t_00"}).empty()) return true;
    return false;
}

Rig read_polycam_rig(const std::filesystem::path& folder, Split split) {
    Rig rig;
    rig.folder = folder;
    rig.format = "polycam";
    rig.images_as_stored = true;
    rig.world = "metres, +Y up";
    for (const auto& [cameras, images] : kPolycamFolders) {
        const Frames found = images_in(folder / images);
        if (found.empty()) continue;
        rig.file = (folder / cameras).string();
        std::vector<CameraFrames> stills;
        for (const auto& [name, image] : found) {
            const JsonFile file = read_json(folder / cameras / (name + ".json"), "a camera of Polycam");
            CameraFrames still{polycam_camera(file.root(), name), name + ".json", stills.size(), {}, {}};
            fit_to_images(still.camera, image, rig, still.place);
            still.frames[kOnlyFrame] = image;
            stills.push_back(std::move(still));
        }
        rig.remarks.emplace_back(kOneMoment);
        if (cameras == kPolycamFolders[0].first && !images_in(folder / kPolycamFolders[1].second).empty())
            rig.remarks.push_back(choice_remark(images, {kPolycamFolders[1].second}));
        add_cameras(rig, stills, split);
        return rig;
    }
    throw InputError(folder.string(), "",
                     fmt::format("holds no images of Polycam in keyframes/images, but {}",
                                 entries_text(folder / kPolycamFolders[1].second)),
                     "export Raw Data in Polycam, with developer mode on");
}

}  // namespace neuvv::training
