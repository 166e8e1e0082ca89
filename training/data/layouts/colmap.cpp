#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "training/data/layouts/colmap_model.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

namespace {

// The folders of models, in the order in which they are looked for: COLMAP writes a folder sparse/N for each part of
// the images that it could not connect to the others.
std::vector<std::filesystem::path> model_folders(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> found;
    for (const char* sparse : {"sparse", "colmap/sparse"}) {
        std::map<std::string, std::filesystem::path, NaturalOrder> parts;
        for (const auto& entry : entries_of(folder / sparse))
            if (holds_colmap_model(entry)) parts[entry.filename().string()] = entry;
        for (const auto& [name, part] : parts) found.push_back(part);
        if (holds_colmap_model(folder / sparse)) found.push_back(folder / sparse);
    }
    if (holds_colmap_model(folder)) found.push_back(folder);
    return found;
}

// The model that places most images, of models alike the first.
Choice choose_model(const std::filesystem::path& folder) {
    const std::vector<std::filesystem::path> models = model_folders(folder);
    if (models.size() < 2) return {models.empty() ? std::filesystem::path() : models[0], ""};
    std::vector<size_t> images;
    for (const auto& model : models) images.push_back(placed_images(model));
    const auto best = static_cast<size_t>(std::ranges::max_element(images) - images.begin());
    const auto text = [&](size_t i) {
        const std::string name = models[i].lexically_relative(folder).string();
        return images[i] > 0 ? fmt::format("{} with {} images", name, images[i])
                             : fmt::format("{}, which cannot be read", name);
    };
    std::vector<std::string> others;
    for (size_t i = 0; i < models.size(); ++i)
        if (i != best) others.push_back(text(i));
    return {models[best], choice_remark(text(best), others)};
}

// Where a model has its files in both formats, the binary ones count, as in COLMAP.
void note_text_files(Rig& rig, const std::filesystem::path& model) {
    std::error_code ignored;
    if (std::filesystem::exists(model / "images.bin", ignored) &&
        std::filesystem::exists(model / "images.txt", ignored))
        rig.remarks.push_back(choice_remark("images.bin", {"images.txt"}));
}

// The camera's name by COLMAP's name of an image: the image's folder, or the file's name where there is no folder.
std::string camera_of_image(const std::string& image) {
    const std::filesystem::path path(image);
    return path.has_parent_path() ? path.parent_path().string() : path.stem().string();
}

// Indices into model.images by the camera's name, in natural order.
using ImagesByCamera = std::map<std::string, std::vector<size_t>, NaturalOrder>;

ImagesByCamera by_camera(const ColmapModel& model) {
    ImagesByCamera result;
    for (size_t i = 0; i < model.images.size(); ++i) result[camera_of_image(model.images[i].name)].push_back(i);
    return result;
}

// The mask of one image: the file that COLMAP looks for ("a.jpg.png"), or one with the image's own name.
ImageSource mask_of(const std::filesystem::path& masks, const std::string& image) {
    const std::filesystem::path beside = masks / image;
    std::error_code ignored;
    for (const std::filesystem::path& file : {std::filesystem::path(beside.string() + ".png"),
                                              std::filesystem::path(beside).replace_extension(".png"), beside})
        if (std::filesystem::is_regular_file(file, ignored)) return {file, -1};
    throw InputError(masks.string(), "", fmt::format("has no mask {}.png", image),
                     "give every image its mask, or take the folder away");
}

// Cameras that stand still, whose frames lie in a folder or a video.
std::vector<CameraFrames> still_cameras(Rig& rig, const ColmapModel& model, const std::filesystem::path& masks) {
    std::vector<CameraFrames> cameras;
    for (const auto& [name, images] : by_camera(model)) {
        if (images.size() != 1) continue;
        CameraFrames camera{model.images[images[0]], model.place[images[0]], cameras.size(), {}, {}};
        camera.camera.name = name;
        camera.frames = frames_of_camera(rig.folder, name);
        if (camera.frames.empty()) continue;
        const ImageSource& first = camera.frames.begin()->second;
        fit_to_images(camera.camera, first, rig, camera.place);
        if (!masks.empty()) camera.masks = masks_of_camera(masks, name, camera.frames);
        cameras.push_back(std::move(camera));
    }
    name_by_time(rig, cameras);
    expect_common_frames(rig, cameras);
    return cameras;
}

// Every image as a camera of its own: either a camera moved, or the scene stood still. For images in folders, the file
// name gives the frame; all other images show the same time.
std::vector<CameraFrames> image_cameras(Rig& rig, const ColmapModel& model, const std::filesystem::path& masks) {
    std::vector<CameraFrames> cameras;
    const ImagesByCamera groups = by_camera(model);
    const std::filesystem::path images_folder = training::images_folder(rig.folder).path;
    size_t group = 0;
    for (const auto& [name, images] : groups) {
        for (const size_t i : images) {
            const std::filesystem::path image(model.images[i].name), file = images_folder / image;
            std::error_code ignored;
            if (!std::filesystem::is_regular_file(file, ignored))
                throw InputError(model.file, model.place[i], fmt::format("there is no image {}", file.string()),
                                 "put it there");
            CameraFrames camera{model.images[i], model.place[i], groups.size() > 1 ? group : cameras.size(), {}, {}};
            camera.camera.name = std::filesystem::path(image).replace_extension().string();
            const std::string frame = image.has_parent_path() ? image.stem().string() : "0";
            camera.frames[frame] = {file, -1};
            fit_to_images(camera.camera, camera.frames[frame], rig, camera.place);
            if (!masks.empty()) camera.masks[frame] = mask_of(masks, model.images[i].name);
            cameras.push_back(std::move(camera));
        }
        ++group;
    }
    return cameras;
}

// A box around nearly all points, enlarged because a performer may move away from where it was reconstructed.
std::optional<std::pair<glm::dvec3, glm::dvec3>> box_of(const std::vector<glm::dvec3>& points) {
    constexpr size_t kMinPoints = 100;
    constexpr double kOutliers = 0.01, kRoom = 0.5, kFarthest = 1e9;
    if (points.size() < kMinPoints) return {};
    std::pair<glm::dvec3, glm::dvec3> box;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> along;
        for (const glm::dvec3& point : points)
            if (std::abs(point[axis]) <= kFarthest) along.push_back(point[axis]);
        if (along.size() < kMinPoints) return {};
        const auto cut = static_cast<ptrdiff_t>(kOutliers * static_cast<double>(along.size()));
        std::nth_element(along.begin(), along.begin() + cut, along.end());
        const double low = along[static_cast<size_t>(cut)];
        std::nth_element(along.begin(), along.end() - 1 - cut, along.end());
        const double high = *(along.end() - 1 - cut);
        if (!(low < high)) return {};
        box.first[axis] = low - kRoom * (high - low);
        box.second[axis] = high + kRoom * (high - low);
    }
    return box;
}

}  // namespace

bool has_colmap_files(const std::filesystem::path& folder) {
    return !model_folders(folder).empty();
}

Rig read_colmap_rig(const std::filesystem::path& folder, Split split) {
    const auto [model_path, remark] = choose_model(folder);
    if (model_path.empty())
        throw InputError(folder.string(), "", "holds no sparse model of COLMAP",
                         "put cameras and images (.bin or .txt) into its sparse/0");
    const ColmapModel model = read_colmap_model(model_path);
    Rig rig;
    rig.folder = folder;
    rig.format = "colmap";
    rig.images_as_stored = true;
    rig.world = "COLMAP's own unit and axes, not turned";
    rig.file = model.file;
    rig.box = box_of(model.points);
    if (!remark.empty()) rig.remarks.push_back(remark);
    note_text_files(rig, model_path);
    const std::filesystem::path masks = first_folder(folder, {"masks", "mask"});
    std::vector<CameraFrames> cameras = still_cameras(rig, model, masks);
    if (cameras.empty()) cameras = image_cameras(rig, model, masks);
    note_choices(rig, cameras);
    note_mask_folders(rig);
    add_cameras(rig, cameras, split);
    return rig;
}

}  // namespace neuvv::training
