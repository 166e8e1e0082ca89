// The conventions are those of Dynamic 3D Gaussians (github.com/JonathonLuiten/Dynamic3DGaussians):
// - train_meta.json and test_meta.json have w, h, and by frame and camera k (3×3), w2c (4×4) and fn ("0/000000.jpg").
//   Images are ims/FN, masks seg/FN with the ending .png, in which 1 is the performer (train.py).
// - w2c takes a point to OpenCV's axes. k has no half pixel to be added: helpers.py makes a projection of it that puts
//   the corner of the image at 0, and visualize.py has pixel centres at +½.
// - −Y is up, as in Panoptic Studio, where its captures come from: train.py pushes the performer out of the floor, y >
// 0,
//   and visualize.py puts its camera 1.3 units above the origin by a w2c that adds 1.3 to y. That is a metre a unit.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "base/formats/json.h"
#include "interchange/camera/json_pose.h"
#include "media/image.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"

namespace neuvv::training {

namespace {

constexpr const char* kTrainMeta = "train_meta.json";
constexpr const char* kTestMeta = "test_meta.json";
constexpr double kStillTolerance = 1e-6;  // between the numbers of a camera at two frames

bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

// The list of a frame's cameras.
JsonNode of_frame(const JsonNode& root, const char* key, size_t frame, size_t cameras) {
    const JsonNode frames = root[key];
    if (!frames.value.is_array()) frames.fail_type("an array");
    if (frame >= frames.value.size()) frames.fail(fmt::format("has no frame {}, as fn has", frame));
    const JsonNode list = frames[frame];
    expect_array(list, cameras);
    return list;
}

RigCamera meta_camera(const JsonNode& root, const JsonNode& k, const JsonNode& w2c) {
    RigCamera camera;
    camera.lens = opencv_lens(json_numbers(k, 9), {}, false, root.file, k.place);
    camera.lens.cx -= 0.5;  // opencv_lens adds it
    camera.lens.cy -= 0.5;
    camera.lens.width = static_cast<uint32_t>(json_count(root["w"], media::kMaxImageSide));
    camera.lens.height = static_cast<uint32_t>(json_count(root["h"], media::kMaxImageSide));
    const glm::dmat4 view = interchange::json_pose(w2c);
    camera.world_from_camera =
        glm::dmat4(interchange::kYUpFromYDown) * world_from_opencv(glm::dmat3(view), glm::dvec3(view[3]));
    expect_sound(camera, root.file, w2c.place);
    return camera;
}

void expect_still(const JsonNode& node, const nlohmann::json& first, size_t count) {
    if (node.value == first) return;
    const std::vector<double> now = json_numbers(node, count),
                              before = json_numbers({first, node.file, node.place}, count);
    for (size_t i = 0; i < count; ++i)
        if (!(std::abs(now[i] - before[i]) <= kStillTolerance))
            node.fail("differs from that of the camera's first frame", "give cameras that stand still");
}

// A camera, and where in the file its first frame is.
struct MetaCamera {
    CameraFrames camera;
    const nlohmann::json *k = nullptr, *w2c = nullptr;
};
using MetaCameras = std::map<std::string, MetaCamera, NaturalOrder>;

// The cameras of both files, and which of their images are missing.
struct MetaFiles {
    MetaCameras cameras;
    std::vector<MissingImage> missing;
    size_t listed = 0;
};

void add_image(const Rig& rig, MetaFiles& files, MetaCamera& from, const std::string& fn, const JsonNode& node) {
    const std::filesystem::path image = rig.folder / "ims" / fn, masks = rig.folder / "seg";
    const std::string frame = image.stem().string();
    ++files.listed;
    if (!is_file(image)) {
        files.missing.push_back({node.place, image});
        return;
    }
    if (!from.camera.frames.try_emplace(frame, ImageSource{image, -1}).second)
        node.fail("is a second image of its camera and frame", "name each image once");
    std::error_code ignored;
    if (!std::filesystem::is_directory(masks, ignored)) return;
    const std::filesystem::path mask = (masks / fn).replace_extension(".png");
    if (!is_file(mask))
        node.fail(fmt::format("there is no mask {}", mask.string()), "give every image its mask, or take seg/ away");
    from.camera.masks[frame] = {mask, -1};
}

// Reads the cameras of a file. Those of one file are of one group.
void read_meta(const Rig& rig, const JsonNode& root, size_t group, MetaFiles& files) {
    const JsonNode fn = root["fn"];
    expect_list(fn);
    for (size_t frame = 0; frame < fn.value.size(); ++frame) {
        const JsonNode names = fn[frame];
        expect_list(names);
        const size_t count = names.value.size();
        const JsonNode k = of_frame(root, "k", frame, count), w2c = of_frame(root, "w2c", frame, count);
        for (size_t c = 0; c < count; ++c) {
            const std::string& path = json_string(names[c]);
            expect_inside(path, root.file, names[c].place);
            const std::string folder = std::filesystem::path(path).parent_path().generic_string();
            if (folder.empty()) names[c].fail("names no folder of its camera", "give CAMERA/FRAME.jpg");
            const auto [at, fresh] = files.cameras.try_emplace(folder);
            MetaCamera& camera = at->second;
            if (fresh) {
                camera = {{meta_camera(root, k[c], w2c[c]), names[c].place, group, {}, {}}, &k[c].value, &w2c[c].value};
                camera.camera.camera.name = folder;
            } else if (camera.camera.group != group) {
                names[c].fail(fmt::format("is of a camera of {}", kTrainMeta), "keep training and test apart");
            }
            expect_still(k[c], *camera.k, 9);
            expect_still(w2c[c], *camera.w2c, 16);
            add_image(rig, files, camera, path, names[c]);
        }
    }
}

}  // namespace

bool has_dynamic3dgs_files(const std::filesystem::path& folder) {
    std::error_code ignored;
    return is_file(folder / kTrainMeta) && std::filesystem::is_directory(folder / "ims", ignored);
}

Rig read_dynamic3dgs_rig(const std::filesystem::path& folder, Split split) {
    const JsonFile train = read_json(folder / kTrainMeta, "the cameras of Dynamic 3D Gaussians");
    Rig rig;
    rig.folder = folder;
    rig.format = "dynamic3dgs";
    rig.images_as_stored = true;
    rig.file = train.name;
    rig.masks = MaskMeaning::kLabels;
    rig.world = "metres where the capture is Panoptic Studio's; +Y up, turned from −Y up";
    constexpr size_t kHeldOut = 0, kTrained = 1;  // add_cameras holds out every 8th group
    const bool has_test = is_file(folder / kTestMeta);
    MetaFiles found;
    read_meta(rig, train.root(), kTrained, found);
    const JsonFile test = has_test ? read_json(folder / kTestMeta, "the cameras held out") : JsonFile();
    if (has_test) read_meta(rig, test.root(), kHeldOut, found);
    leave_out(rig, found.missing, found.listed);
    std::vector<CameraFrames> cameras;
    for (auto& [name, from] : found.cameras) {
        if (from.camera.frames.empty()) continue;
        fit_to_images(from.camera.camera, from.camera.frames.begin()->second, rig, from.camera.place);
        cameras.push_back(std::move(from.camera));
        if (!has_test) cameras.back().group = cameras.size() - 1;
    }
    expect_common_frames(rig, cameras);
    add_cameras(rig, cameras, split);
    return rig;
}

}  // namespace neuvv::training
