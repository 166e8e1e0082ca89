// The conventions are those that Record3D's author gives (github.com/marek-simonik/record3d, issues 27, 33, 36 and 64):
// poses[i] is qx qy qz qw x y z, from the camera (OpenGL axes) to the world, in metres. The world is that of the first
// image, so it need not be level. K is a camera matrix, column by column, and perFrameIntrinsicCoeffs[i] is fx fy cx
// cy. Image i is rgb/i.jpg (or .png), in an .r3d file, which is a ZIP archive, rgbd/i.jpg.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

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

// Where the metadata and the images lie.
struct Recording {
    std::filesystem::path metadata, images;
};

// The recordings in the folder, the one that counts first.
std::vector<Recording> find_recordings(const std::filesystem::path& folder) {
    std::vector<Recording> found;
    std::error_code ignored;
    for (const auto& inside : {folder, folder / "EXR_RGBD"})
        for (const char* name : {"metadata.json", "metadata"})
            for (const char* images : {"rgb", "rgbd"})
                if (std::filesystem::is_regular_file(inside / name, ignored) &&
                    std::filesystem::is_directory(inside / images, ignored))
                    found.push_back({inside / name, inside / images});
    return found;
}

glm::dmat4 record3d_pose(const JsonNode& node) {
    expect_array(node, 7);
    std::array<double, 7> p{};
    for (size_t i = 0; i < p.size(); ++i) p[i] = json_number(node[i]);
    const glm::dquat turn(p[3], p[0], p[1], p[2]);  // glm's order is w x y z
    if (!(std::abs(glm::length(turn) - 1) < interchange::kUnitTolerance))
        node.fail("is no unit quaternion and position");
    glm::dmat4 pose = glm::mat4_cast(glm::normalize(turn));
    pose[3] = {p[4], p[5], p[6], 1};
    return pose;
}

glm::dvec4 four_numbers(const JsonNode& list, size_t size, std::array<size_t, 4> at) {
    expect_array(list, size);
    return {json_number(list[at[0]]), json_number(list[at[1]]), json_number(list[at[2]]), json_number(list[at[3]])};
}

// fx, fy, cx and cy of an image.
glm::dvec4 intrinsics_of(const JsonNode& root, size_t i) {
    if (root.has("perFrameIntrinsicCoeffs"))
        if (const JsonNode list = root["perFrameIntrinsicCoeffs"]; i < list.value.size()) {
            expect_list(list);
            return four_numbers(list[i], 4, {0, 1, 2, 3});
        }
    return four_numbers(root["K"], 9, {0, 4, 6, 7});
}

RigCamera record3d_camera(const JsonNode& root, const std::string& name) {
    size_t i = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), i);
    const JsonNode poses = root["poses"];
    if (!poses.value.is_array()) poses.fail_type("an array");
    if (error != std::errc() || end != name.data() + name.size() || i >= poses.value.size())
        poses.fail(fmt::format("has {} poses, and none for the image {}", poses.value.size(), name),
                   "name image i by its number, 0.jpg, 1.jpg …, or remove it");
    RigCamera camera;
    camera.name = name;
    camera.world_from_camera = record3d_pose(poses[i]);
    const glm::dvec4 k = intrinsics_of(root, i);
    camera.lens.fx = k.x;
    camera.lens.fy = k.y;
    camera.lens.cx = k.z;
    camera.lens.cy = k.w;
    camera.lens.width = static_cast<uint32_t>(json_count(root["w"], media::kMaxImageSide));
    camera.lens.height = static_cast<uint32_t>(json_count(root["h"], media::kMaxImageSide));
    expect_sound(camera, root.file, poses[i].place);
    return camera;
}

}  // namespace

bool has_record3d_files(const std::filesystem::path& folder) {
    return !find_recordings(folder).empty();
}

Rig read_record3d_rig(const std::filesystem::path& folder, Split split) {
    const std::vector<Recording> recordings = find_recordings(folder);
    if (recordings.empty())
        throw InputError(folder.string(), "", "holds no metadata and rgb/ of Record3D",
                         "export EXR + RGB in Record3D, or unzip the .r3d file");
    const Recording& recording = recordings[0];
    const JsonFile file = read_json(recording.metadata, "the metadata of Record3D");
    Rig rig;
    rig.folder = folder;
    rig.format = "record3d";
    rig.images_as_stored = true;
    rig.file = file.name;
    rig.world = "metres; +Y is up in the first image, and level only where the phone was";
    if (recordings.size() > 1) {
        const auto text = [&](const Recording& from) {
            return from.metadata.lexically_relative(folder).string() + " with " +
                   from.images.lexically_relative(folder).string() + "/";
        };
        rig.remarks.push_back(choice_remark(text(recording), {text(recordings[1])}));
    }
    std::vector<CameraFrames> stills;
    for (const auto& [name, image] : images_in(recording.images)) {
        CameraFrames still{record3d_camera(file.root(), name), fmt::format("poses[{}]", name), stills.size(), {}, {}};
        fit_to_images(still.camera, image, rig, still.place);
        still.frames[kOnlyFrame] = image;
        stills.push_back(std::move(still));
    }
    if (stills.empty())
        throw InputError(recording.images.string(), "",
                         fmt::format("holds no .png or .jpg, but {}", entries_text(recording.images)),
                         "export the recording again");
    rig.remarks.emplace_back(kOneMoment);
    add_cameras(rig, stills, split);
    return rig;
}

}  // namespace neuvv::training
