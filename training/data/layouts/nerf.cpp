#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "media/image.h"
#include "training/data/layouts/nerf_images.h"
#include "training/data/layouts/nerf_splits.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_names.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

namespace {

// Other transforms files of the folder. Those of the other splits are no alternatives.
void note_other_files(Rig& rig) {
    std::vector<std::string> others;
    const std::string read = std::filesystem::path(rig.file).filename().string();
    for (const auto& entry : entries_of(rig.folder)) {
        const std::string name = entry.filename().string();
        const bool of_split = read != "transforms.json" && is_split_file(rig.folder, entry);
        if (name.starts_with("transforms") && name.ends_with(".json") && name != read && !of_split)
            others.push_back(name);
    }
    if (!others.empty()) rig.remarks.push_back(choice_remark(read, others));
}

// Says where a file gives a focal length and an angle of view that contradict each other, as after a scaling of the
// images of which only one knows.
void note_contradicting_angle(Rig& rig, const interchange::Intrinsics& in, const RigCamera& camera,
                              const std::string& place) {
    constexpr double kTolerance = 0.01;
    const auto differs = [&](std::optional<double> pixels, std::optional<double> angle, double side) {
        return pixels && angle && std::abs(0.5 * side / std::tan(0.5 * *angle) / *pixels - 1) > kTolerance;
    };
    const bool across = differs(in.fl_x, in.camera_angle_x, camera.lens.width);
    if (!across && !differs(in.fl_y, in.camera_angle_y, camera.lens.height)) return;
    const char axis = across ? 'x' : 'y';
    const std::string remark =
        fmt::format("{}: fl_{} was read, not camera_angle_{}, which contradicts it", place, axis, axis);
    const std::string rest = remark.substr(place.size());
    if (std::ranges::none_of(rig.remarks, [&](const std::string& other) { return other.ends_with(rest); }))
        rig.remarks.push_back(remark);
}

std::string stem(const interchange::TransformsFrame& frame) {
    return std::filesystem::path(frame.file_path).stem().string();
}

// Where no frame has a time and a camera has several, images of one name are of one time, whatever their split: the
// i-th of N names has the time i/(N−1).
void time_by_name(const Rig& rig, std::vector<ImageFrame>& frames,
                  const std::vector<interchange::TransformsFrame>& others) {
    std::vector<interchange::TransformsFrame> all = others;
    for (const ImageFrame& frame : frames) all.push_back(frame.frame);
    if (std::ranges::any_of(all, [](const interchange::TransformsFrame& frame) { return frame.time.has_value(); }))
        return;
    const std::vector<uint32_t> cameras = number_cameras(all);
    std::set<std::pair<uint32_t, std::string>> images;  // an image, or a copy of it, may be of two splits
    std::map<std::string, double, NaturalOrder> times;
    for (size_t i = 0; i < all.size(); ++i) {
        images.emplace(cameras[i], stem(all[i]));
        times.try_emplace(stem(all[i]), 0);
    }
    const size_t count = 1 + *std::max_element(cameras.begin(), cameras.end());
    if (images.size() == count) return;
    if (count > 1 && times.size() == images.size()) {
        if (images.size() < 2 * count) return;  // one camera that moved, and stood still now and then
        throw InputError(rig.file, "frames", "have no time, and no image of one camera is named as one of another",
                         "give each frame its time, or images of the same time the same name, in a folder a camera");
    }
    const double last = std::max(1.0, static_cast<double>(times.size()) - 1);
    double next = 0;
    for (auto& [name, time] : times) time = next++ / last;
    for (ImageFrame& frame : frames) frame.frame.time = times.at(stem(frame.frame));
}

RigCamera make_camera(Rig& rig, const interchange::TransformsFrame& frame, const std::string& name,
                      ImageSource first_image) {
    const interchange::Intrinsics& in = frame.intrinsics;
    first_image.as_stored = rig.images_as_stored;
    const media::ImageSize size = in.width ? media::ImageSize{in.width, in.height} : size_of(first_image);
    RigCamera camera;
    camera.name = name;
    camera.world_from_camera = frame.world_from_camera;
    camera.lens = interchange::make_lens(in, size.width, size.height);
    note_contradicting_angle(rig, in, camera, frame.place);
    if (!frame.background_path.empty())
        camera.plate.path = find_image(rig, frame.background_path, frame.place + ".background_path");
    return camera;
}

// A name for each camera of these frames: the folder of its images where each camera has one of its own, else what the
// names of its images have in common, else its number.
std::vector<std::string> names_of_cameras(const std::vector<interchange::TransformsFrame>& frames,
                                          const std::vector<uint32_t>& cameras) {
    const size_t count = frames.empty() ? 0 : 1 + *std::ranges::max_element(cameras);
    std::vector<std::set<std::string>> folders(count);
    std::vector<std::vector<std::string>> stems(count), paths(count);
    for (size_t i = 0; i < frames.size(); ++i) {
        const std::filesystem::path path = std::filesystem::path(frames[i].file_path).lexically_normal();
        folders[cameras[i]].insert(path.parent_path().filename().string());
        stems[cameras[i]].push_back(path.stem().string());
        std::string whole = std::filesystem::path(path).replace_extension().generic_string();
        std::ranges::replace(whole, '/', '_');
        paths[cameras[i]].push_back(whole);
    }
    std::vector<std::vector<std::string>> in_folders(count);
    bool own_folders = count > 1;
    for (size_t c = 0; c < count; ++c) {
        own_folders &= folders[c].size() == 1;
        in_folders[c] = {*folders[c].begin()};
    }
    if (own_folders)
        if (auto names = names_by_images(in_folders)) return *names;
    for (const auto& images : {stems, paths})
        if (auto names = names_by_images(images)) return *names;
    std::vector<std::string> numbers;
    for (size_t c = 0; c < count; ++c) numbers.push_back(fmt::format("{}", c));
    return numbers;
}

// `others`: the frames of the other splits, from whose cameras names must differ.
void add_cameras_and_shots(Rig& rig, const std::vector<ImageFrame>& images,
                           std::vector<interchange::TransformsFrame> others) {
    std::vector<interchange::TransformsFrame> frames;
    for (const ImageFrame& image : images) frames.push_back(image.frame);
    const std::vector<uint32_t> cameras = number_cameras(frames);
    others.insert(others.begin(), frames.begin(), frames.end());  // first, so that numbers are those of `cameras`
    const std::vector<uint32_t> all = number_cameras(others);
    for (size_t i = 0; i < others.size(); ++i)
        if (all[i] == rig.poses.size()) rig.poses.push_back(others[i].world_from_camera);
    const std::vector<std::string> names = names_of_cameras(others, all);
    std::vector<const interchange::TransformsFrame*> first;  // by camera
    for (size_t i = 0; i < frames.size(); ++i) {
        const interchange::TransformsFrame& frame = frames[i];
        Shot shot;
        shot.camera = cameras[i];
        shot.time = frame.time.value_or(0);
        shot.place = frame.place;
        shot.image = images[i].image;
        if (shot.camera == first.size()) {
            first.push_back(&frame);
            rig.cameras.push_back(make_camera(rig, frame, names.at(shot.camera), shot.image));
        }
        if (frame.background_path != first[shot.camera]->background_path)
            throw InputError(rig.file, frame.place + ".background_path",
                             "differs from that of the same camera in " + first[shot.camera]->place,
                             "give one clean plate to all frames of a camera, or none");
        rig.shots.push_back(std::move(shot));
    }
}

// Whether all frames have a field. Throws InputError where only some have it.
template <typename HasField>
bool has_everywhere(const Rig& rig, const std::vector<ImageFrame>& frames, const char* field,
                    const HasField& has_field) {
    const auto lacking = std::find_if_not(frames.begin(), frames.end(), has_field);
    if (lacking == frames.end()) return true;
    if (std::none_of(frames.begin(), frames.end(), has_field)) return false;
    throw InputError(rig.file, lacking->frame.place, fmt::format("has no {}, but other frames have one", field),
                     "give it to all frames or none");
}

// Finds the masks: nerfstudio names one for every frame, instant-ngp looks for a file beside each image.
void find_masks(Rig& rig, const std::vector<ImageFrame>& frames) {
    if (has_everywhere(rig, frames, "mask_path", [](const auto& image) { return !image.frame.mask_path.empty(); })) {
        rig.masks = MaskMeaning::kUsable;
        for (size_t i = 0; i < frames.size(); ++i) rig.shots[i].mask = frames[i].mask;
        return;
    }
    rig.masks = MaskMeaning::kIgnore;
    for (Shot& shot : rig.shots) {
        const auto& image = shot.image.path;
        const auto mask = image.parent_path() / fmt::format("dynamic_mask_{}.png", image.stem().string());
        if (shot.image.video_frame < 0 && holds_file(mask)) shot.mask.path = mask;
    }
}

// Names each image after its file; where another image of any split has the same name, folders become part of the
// names.
void name_shots(Rig& rig, const std::vector<ImageFrame>& frames,
                const std::vector<interchange::TransformsFrame>& others) {
    std::map<std::string, int> uses;
    for (const ImageFrame& image : frames) ++uses[stem(image.frame)];
    for (const interchange::TransformsFrame& frame : others) ++uses[stem(frame)];
    const bool distinct = std::all_of(uses.begin(), uses.end(), [](const auto& use) { return use.second == 1; });
    for (size_t i = 0; i < frames.size(); ++i) {
        const ImageSource& image = frames[i].image;
        std::filesystem::path path = frames[i].frame.file_path;
        if (image.video_frame < 0) path = image.path.lexically_relative(rig.folder);
        path = path.lexically_normal();
        std::string name =
            distinct ? path.stem().string() : std::filesystem::path(path).replace_extension().generic_string();
        std::replace(name.begin(), name.end(), '/', '_');
        rig.shots[i].name = name;
    }
}

}  // namespace

bool has_nerf_files(const std::filesystem::path& folder) {
    return has_split_files(folder) || holds_file(folder / "transforms.json");
}

Rig read_nerf_rig(const std::filesystem::path& folder, Split split) {
    const auto [file, transforms, other_frames] = read_split(folder, split);
    Rig rig;
    rig.folder = folder;
    rig.format = "nerf";
    rig.images_as_stored = true;
    rig.world =
        transforms.z_up ? "the file's unit, a metre; +Y up, turned from +Z up" : "the file's unit, a metre; +Y up";
    rig.file = file.string();
    rig.box = transforms.box;
    rig.fps = transforms.fps;
    note_other_files(rig);
    note_endings(rig, transforms.frames);
    const Sequences sequences = find_sequences(rig, transforms.frames, other_frames);
    std::vector<interchange::TransformsFrame> others = spread_frames(rig, other_frames, sequences);
    std::vector<ImageFrame> images = image_frames(rig, transforms.frames, sequences, others);
    has_everywhere(rig, images, "time", [](const auto& image) { return image.frame.time.has_value(); });
    time_by_name(rig, images, others);
    add_cameras_and_shots(rig, images, others);
    find_masks(rig, images);
    name_shots(rig, images, others);
    return rig;
}

}  // namespace neuvv::training
