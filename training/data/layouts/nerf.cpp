#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "media/image.h"
#include "training/data/image_reader.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/camera_names.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/transforms.h"

namespace neuvv::training {

namespace {

// Frames are of the same camera where these numbers are equal: pose and intrinsics as the file gives them.
using CameraIdentity = std::vector<double>;

CameraIdentity identity(const TransformsFrame& frame) {
    constexpr double kAbsent = std::numeric_limits<double>::infinity();
    const Intrinsics& in = frame.intrinsics;
    CameraIdentity key = {in.fl_x.value_or(kAbsent),
                          in.camera_angle_x.value_or(kAbsent),
                          in.camera_angle_y.value_or(kAbsent),
                          in.fl_y.value_or(kAbsent),
                          in.cx.value_or(kAbsent),
                          in.cy.value_or(kAbsent),
                          1.0 * in.width,
                          1.0 * in.height,
                          static_cast<double>(in.lens_model),
                          in.p1,
                          in.p2};
    key.insert(key.end(), in.k.begin(), in.k.end());
    for (int i = 0; i < 12; ++i) key.push_back(frame.world_from_camera[i / 3][i % 3]);
    return key;
}

// The number of each frame's camera, in order of first use.
std::vector<uint32_t> number_cameras(const std::vector<TransformsFrame>& frames) {
    std::map<CameraIdentity, uint32_t> seen;
    std::vector<uint32_t> cameras;
    cameras.reserve(frames.size());
    for (const TransformsFrame& frame : frames)
        cameras.push_back(seen.try_emplace(identity(frame), static_cast<uint32_t>(seen.size())).first->second);
    return cameras;
}

bool holds_file(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::exists(file, ignored);
}

// The frames of a split, and the file that has them.
struct SplitFrames {
    std::filesystem::path file;
    Transforms transforms;
    std::vector<TransformsFrame> other_frames;  // of the other splits
};

constexpr const char* kSplitNames[] = {"train", "test", "val"};  // by Split

const char* name_of(Split split) {
    return kSplitNames[static_cast<size_t>(split)];
}

std::filesystem::path split_file(const std::filesystem::path& folder, const char* split) {
    return folder / fmt::format("transforms_{}.json", split);
}

// Reads the training frames, and behind them those of the test.
SplitFrames read_files_of_all_splits(const std::filesystem::path& folder) {
    SplitFrames result;
    for (const char* split : {"train", "test"}) {
        const auto file = split_file(folder, split);
        if (!holds_file(file)) continue;
        Transforms transforms = read_transforms(file);
        if (result.file.empty()) {
            result.file = file;
            result.transforms = std::move(transforms);
        } else {
            for (TransformsFrame& frame : transforms.frames) result.transforms.frames.push_back(std::move(frame));
        }
    }
    if (result.file.empty())
        throw InputError(split_file(folder, "train").string(), "", "does not exist", "give the training images' file");
    return result;
}

// Reads transforms_train.json, transforms_test.json or transforms_val.json, each of which has the frames of one split.
SplitFrames read_file_of_split(const std::filesystem::path& folder, Split split) {
    if (split == Split::kAll) return read_files_of_all_splits(folder);
    SplitFrames result;
    result.file = split_file(folder, name_of(split));
    result.transforms = read_transforms(result.file);
    for (const char* other : kSplitNames) {
        const auto file = split_file(folder, other);
        if (file == result.file || !holds_file(file)) continue;
        for (TransformsFrame& frame : read_transforms(file).frames) result.other_frames.push_back(std::move(frame));
    }
    return result;
}

std::string normal(const std::string& path) {
    return std::filesystem::path(path).lexically_normal().generic_string();
}

// Which frames are of the split by nerfstudio's lists.
std::vector<bool> members_by_list(const std::string& file, const Transforms& all, Split split) {
    std::map<std::string, size_t> list_of;
    for (size_t s = 0; s < all.split_files.size(); ++s)
        for (const std::string& path : all.split_files[s].value_or(std::vector<std::string>()))
            if (const auto [at, fresh] = list_of.try_emplace(normal(path), s); !fresh && at->second != s)
                throw InputError(file, fmt::format("{}_filenames", kSplitNames[s]),
                                 fmt::format("names {}, which is in {}_filenames, too", path, kSplitNames[at->second]),
                                 "keep training and test apart");
    std::vector<bool> members;
    std::set<std::string> frames;
    for (const TransformsFrame& frame : all.frames) {
        const auto listed = list_of.find(*frames.insert(normal(frame.file_path)).first);
        members.push_back(listed != list_of.end() && listed->second == static_cast<size_t>(split));
    }
    for (const auto& [path, s] : list_of)
        if (!frames.contains(path))
            throw InputError(file, fmt::format("{}_filenames", kSplitNames[s]),
                             fmt::format("names {}, which is no file_path of a frame", path), "correct the list");
    if (std::find(members.begin(), members.end(), true) == members.end())
        throw InputError(file, fmt::format("{}_filenames", name_of(split)), "is missing or empty",
                         "name the images of that split");
    return members;
}

// Which frames are of the split where every 8th camera is held out for the test.
std::vector<bool> members_by_camera(const std::string& file, const Transforms& all, Split split) {
    if (split == Split::kVal)
        throw InputError(file, "", "has no validation split", "give val_filenames or transforms_val.json");
    const std::vector<uint32_t> cameras = number_cameras(all.frames);
    if (*std::max_element(cameras.begin(), cameras.end()) == 0)
        throw InputError(file, "frames", "has one camera, and one must be held out for the test",
                         "give two cameras or more, transforms_train.json and transforms_test.json, or `--holdout 0`");
    std::vector<bool> members;
    for (const uint32_t camera : cameras) members.push_back((camera % kHoldOut == 0) == (split == Split::kTest));
    return members;
}

SplitFrames read_shared_file(const std::filesystem::path& folder, Split split) {
    SplitFrames result;
    result.file = folder / "transforms.json";
    Transforms& all = result.transforms = read_transforms(result.file);
    if (split == Split::kAll) return result;
    const bool listed =
        std::any_of(all.split_files.begin(), all.split_files.end(), [](const auto& list) { return list.has_value(); });
    const std::vector<bool> members = (listed ? members_by_list : members_by_camera)(result.file.string(), all, split);
    std::vector<TransformsFrame> kept;
    for (size_t i = 0; i < all.frames.size(); ++i) {
        (members[i] ? kept : result.other_frames).push_back(std::move(all.frames[i]));
    }
    all.frames = std::move(kept);
    return result;
}

SplitFrames read_split(const std::filesystem::path& folder, Split split) {
    const bool one_file_each = std::any_of(std::begin(kSplitNames), std::end(kSplitNames),
                                           [&](const char* name) { return holds_file(split_file(folder, name)); });
    return one_file_each ? read_file_of_split(folder, split) : read_shared_file(folder, split);
}

// The image `path`, or `path` with the extension of an image, as D-NeRF gives none; empty where there is neither.
std::filesystem::path image_at(const std::filesystem::path& folder, const std::string& path) {
    std::error_code ignored;
    for (const char* ending : {"", ".png", ".jpg", ".jpeg"}) {
        std::filesystem::path candidate = folder / (path + ending);
        if (std::filesystem::is_regular_file(candidate, ignored)) return candidate;
    }
    return {};
}

// Where a path has no ending, the .png counts, as in D-NeRF's own loader.
void note_endings(Rig& rig, const std::vector<TransformsFrame>& frames) {
    size_t count = 0;
    std::string first, other;
    for (const TransformsFrame& frame : frames) {
        const std::filesystem::path image = image_at(rig.folder, frame.file_path);
        if (image.empty() || image == rig.folder / frame.file_path) continue;
        for (const char* ending : {".png", ".jpg", ".jpeg"}) {
            const std::filesystem::path twin = rig.folder / (frame.file_path + ending);
            if (twin == image || !holds_file(twin) || count++ > 0) continue;
            first = image.lexically_relative(rig.folder).string();
            other = twin.lexically_relative(rig.folder).string();
        }
    }
    if (count > 0)
        rig.remarks.push_back(choice_remark(first, {other}) +
                              (count > 1 ? fmt::format(", and alike in {} cases", count) : ""));
}

// Other transforms files of the folder. Those of the other splits are no alternatives.
void note_other_files(Rig& rig) {
    std::vector<std::string> others;
    const std::string read = std::filesystem::path(rig.file).filename().string();
    for (const auto& entry : entries_of(rig.folder)) {
        const std::string name = entry.filename().string();
        const bool of_split = read != "transforms.json" && std::ranges::any_of(kSplitNames, [&](const char* split) {
                                  return entry == split_file(rig.folder, split);
                              });
        if (name.starts_with("transforms") && name.ends_with(".json") && name != read && !of_split)
            others.push_back(name);
    }
    if (!others.empty()) rig.remarks.push_back(choice_remark(read, others));
}

// Says where a file gives a focal length and an angle of view that contradict each other, as after a scaling of the
// images of which only one knows.
void note_contradicting_angle(Rig& rig, const Intrinsics& in, const RigCamera& camera, const std::string& place) {
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

std::filesystem::path find_image(const Rig& rig, const std::string& path, const std::string& place) {
    const std::filesystem::path image = image_at(rig.folder, path);
    if (!image.empty()) return image;
    throw InputError(rig.file, place, fmt::format("there is no image {0} nor {0}.png", (rig.folder / path).string()),
                     "put it there or correct the path");
}

// A frame of the file, or one image of the folder or of the video that it names: its file_path then ends in the name of
// the image, or in the number of the video's frame.
struct ImageFrame {
    TransformsFrame frame;
    ImageSource image, mask;
};

// The images of a folder or a video, and their masks.
struct Sequence {
    Frames frames, masks;
};
using Sequences = std::map<std::string, Sequence>;  // by file_path

// Those that frames of all splits name. Frames of videos are named by their times.
Sequences find_sequences(Rig& rig, const std::vector<TransformsFrame>& first,
                         const std::vector<TransformsFrame>& others) {
    std::map<std::string, CameraFrames> found;
    for (const std::vector<TransformsFrame>* frames : {&first, &others})
        for (const TransformsFrame& from : *frames) {
            const std::filesystem::path path = rig.folder / from.file_path, mask = rig.folder / from.mask_path;
            const std::filesystem::path image = image_at(rig.folder, from.file_path);
            if (from.file_path.empty() || (!image.empty() && !is_video(image)) || found.contains(from.file_path))
                continue;
            CameraFrames camera;
            camera.camera.name = without_extension(path.filename().string());
            camera.frames = image.empty() ? images_in(path) : frames_of_video(path);
            if (camera.frames.empty()) continue;
            if (!from.mask_path.empty())
                camera.masks =
                    masks_of_camera(mask.parent_path(), without_extension(mask.filename().string()), camera.frames);
            found[from.file_path] = std::move(camera);
        }
    std::vector<CameraFrames> cameras;
    for (const auto& [path, camera] : found) cameras.push_back(camera);
    name_by_time(rig, cameras);
    Sequences sequences;
    for (size_t i = 0; const auto& [path, camera] : found) {
        sequences[path] = {std::move(cameras[i].frames), std::move(cameras[i].masks)};
        ++i;
    }
    return sequences;
}

// The images of a frame that names a folder or a video; empty where it names an image, or what does not exist.
std::vector<ImageFrame> images_of_sequence(const Rig& rig, const TransformsFrame& from, const Sequences& sequences) {
    const auto found = sequences.find(from.file_path);
    if (found == sequences.end()) return {};
    if (from.time)
        throw InputError(rig.file, from.place + ".time", "is given beside a file_path of many images",
                         "remove it: images of the same name, or moment of their videos, are of the same time");
    const auto& [frames, masks] = found->second;
    std::vector<ImageFrame> result;
    for (const auto& [name, source] : frames) {
        ImageFrame added{from, source, masks.empty() ? ImageSource() : masks.at(name)};
        const std::filesystem::path camera(from.file_path);
        added.frame.file_path =
            (camera.parent_path() / without_extension(camera.filename().string()) / (name + ".png")).generic_string();
        added.frame.place += fmt::format(", image {}", name);
        result.push_back(std::move(added));
    }
    return result;
}

std::vector<ImageFrame> image_frames(const Rig& rig, const std::vector<TransformsFrame>& frames,
                                     const Sequences& sequences) {
    std::vector<ImageFrame> result;
    for (const TransformsFrame& frame : frames) {
        if (frame.file_path.empty()) throw InputError(rig.file, frame.place, "has no file_path", "name its image");
        std::vector<ImageFrame> sequence = images_of_sequence(rig, frame, sequences);
        if (sequence.empty()) {
            sequence.push_back({frame, {find_image(rig, frame.file_path, frame.place + ".file_path"), -1}, {}});
            if (!frame.mask_path.empty())
                sequence[0].mask.path = find_image(rig, frame.mask_path, frame.place + ".mask_path");
        }
        std::ranges::move(sequence, std::back_inserter(result));
    }
    return result;
}

// The frames of the other splits, with their sequences spread out. Their images need not exist.
std::vector<TransformsFrame> spread_frames(const Rig& rig, const std::vector<TransformsFrame>& frames,
                                           const Sequences& sequences) {
    std::vector<TransformsFrame> result;
    for (const TransformsFrame& frame : frames) {
        const std::vector<ImageFrame> sequence = images_of_sequence(rig, frame, sequences);
        if (sequence.empty()) result.push_back(frame);
        for (const ImageFrame& image : sequence) result.push_back(image.frame);
    }
    return result;
}

std::string stem(const TransformsFrame& frame) {
    return std::filesystem::path(frame.file_path).stem().string();
}

// Where no frame has a time and a camera has several, images of one name are of one time, whatever their split: the
// i-th of N names has the time i/(N−1).
void time_by_name(const Rig& rig, std::vector<ImageFrame>& frames, const std::vector<TransformsFrame>& others) {
    std::vector<TransformsFrame> all = others;
    for (const ImageFrame& frame : frames) all.push_back(frame.frame);
    if (std::ranges::any_of(all, [](const TransformsFrame& frame) { return frame.time.has_value(); })) return;
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

RigCamera make_camera(Rig& rig, const TransformsFrame& frame, const std::string& name, ImageSource first_image) {
    const Intrinsics& in = frame.intrinsics;
    first_image.as_stored = rig.images_as_stored;
    const media::ImageSize size = in.width ? media::ImageSize{in.width, in.height} : size_of(first_image);
    RigCamera camera;
    camera.name = name;
    camera.world_from_camera = frame.world_from_camera;
    camera.lens = make_lens(in, size.width, size.height);
    note_contradicting_angle(rig, in, camera, frame.place);
    if (!frame.background_path.empty())
        camera.plate.path = find_image(rig, frame.background_path, frame.place + ".background_path");
    return camera;
}

// A name for each camera of these frames: the folder of its images where each camera has one of its own, else what the
// names of its images have in common, else its number.
std::vector<std::string> names_of_cameras(const std::vector<TransformsFrame>& frames,
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
void add_cameras_and_shots(Rig& rig, const std::vector<ImageFrame>& images, std::vector<TransformsFrame> others) {
    std::vector<TransformsFrame> frames;
    for (const ImageFrame& image : images) frames.push_back(image.frame);
    const std::vector<uint32_t> cameras = number_cameras(frames);
    others.insert(others.begin(), frames.begin(), frames.end());  // first, so that numbers are those of `cameras`
    const std::vector<uint32_t> all = number_cameras(others);
    for (size_t i = 0; i < others.size(); ++i)
        if (all[i] == rig.poses.size()) rig.poses.push_back(others[i].world_from_camera);
    const std::vector<std::string> names = names_of_cameras(others, all);
    std::vector<const TransformsFrame*> first;  // by camera
    for (size_t i = 0; i < frames.size(); ++i) {
        const TransformsFrame& frame = frames[i];
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
void name_shots(Rig& rig, const std::vector<ImageFrame>& frames, const std::vector<TransformsFrame>& others) {
    std::map<std::string, int> uses;
    for (const ImageFrame& image : frames) ++uses[stem(image.frame)];
    for (const TransformsFrame& frame : others) ++uses[stem(frame)];
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
    for (const char* name : kSplitNames)
        if (holds_file(split_file(folder, name))) return true;
    return holds_file(folder / "transforms.json");
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
    std::vector<ImageFrame> images = image_frames(rig, transforms.frames, sequences);
    const std::vector<TransformsFrame> others = spread_frames(rig, other_frames, sequences);
    has_everywhere(rig, images, "time", [](const auto& image) { return image.frame.time.has_value(); });
    time_by_name(rig, images, others);
    add_cameras_and_shots(rig, images, others);
    find_masks(rig, images);
    name_shots(rig, images, others);
    return rig;
}

}  // namespace neuvv::training
