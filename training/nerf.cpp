#include "training/nerf.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "media/image.h"
#include "training/transforms.h"

namespace neuvv {

namespace {

constexpr uint32_t kHoldOut = 8;  // of one transforms.json, every 8th camera is for the test

// What makes two frames the same camera: pose and intrinsics as the file gives them.
using CameraIdentity = std::array<double, 19>;

CameraIdentity identity(const TransformsFrame& frame) {
    constexpr double kAbsent = std::numeric_limits<double>::infinity();
    const Intrinsics& in = frame.intrinsics;
    CameraIdentity key{};
    for (int i = 0; i < 12; ++i) key[static_cast<size_t>(i)] = frame.world_from_camera[i / 3][i % 3];
    const std::array rest{in.fl_x.value_or(kAbsent), in.camera_angle_x.value_or(kAbsent),
                          in.fl_y.value_or(kAbsent), in.cx.value_or(kAbsent),
                          in.cy.value_or(kAbsent),   double{1.0 * in.width},
                          double{1.0 * in.height}};
    std::copy(rest.begin(), rest.end(), key.begin() + 12);
    return key;
}

// Each frame's camera, numbered in order of first use.
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

// The file of a split, with only that split's frames in it.
std::pair<std::filesystem::path, Transforms> read_split(const std::filesystem::path& folder, Split split) {
    const bool test = split == Split::kTest;
    const auto train_file = folder / "transforms_train.json", test_file = folder / "transforms_test.json";
    const auto single_file = folder / "transforms.json";
    if (holds_file(train_file) || holds_file(test_file)) {
        const auto file = test ? test_file : train_file;
        return {file, read_transforms(file)};
    }
    Transforms all = read_transforms(single_file);
    const std::vector<uint32_t> cameras = number_cameras(all.frames);
    if (*std::max_element(cameras.begin(), cameras.end()) == 0)
        throw InputError(single_file.string(), "frames", "has one camera, and one must be held out for the test",
                         "give two cameras or more, or transforms_train.json and transforms_test.json");
    std::vector<TransformsFrame> kept;
    for (size_t i = 0; i < all.frames.size(); ++i)
        if ((cameras[i] % kHoldOut == 0) == test) kept.push_back(std::move(all.frames[i]));
    all.frames = std::move(kept);
    return {single_file, std::move(all)};
}

// `path` as given, else with ".png".
std::filesystem::path find_picture(const Rig& rig, const std::string& path, const std::string& place) {
    std::error_code ignored;
    for (const char* ending : {"", ".png"}) {
        std::filesystem::path candidate = rig.folder / (path + ending);
        if (std::filesystem::is_regular_file(candidate, ignored)) return candidate;
    }
    throw InputError(rig.file, place, fmt::format("there is no picture {0} nor {0}.png", (rig.folder / path).string()),
                     "put it there or correct the path");
}

// The lens of a camera whose first picture is `picture`.
Lens make_lens(const TransformsFrame& frame, const std::filesystem::path& picture) {
    const Intrinsics& in = frame.intrinsics;
    const ImageSize size = in.width ? ImageSize{in.width, in.height} : image_size(picture);
    const Camera camera = make_camera(frame, size.width, size.height);
    Lens lens;
    lens.fx = camera.fx;
    lens.fy = camera.fy;
    lens.cx = camera.cx;
    lens.cy = camera.cy;
    lens.width = size.width;
    lens.height = size.height;
    return lens;
}

void add_cameras_and_shots(Rig& rig, const std::vector<TransformsFrame>& frames) {
    const std::vector<uint32_t> cameras = number_cameras(frames);
    std::vector<const TransformsFrame*> first;  // by camera
    for (size_t i = 0; i < frames.size(); ++i) {
        const TransformsFrame& frame = frames[i];
        if (frame.file_path.empty()) throw InputError(rig.file, frame.place, "has no file_path", "name its picture");
        Shot shot;
        shot.camera = cameras[i];
        shot.time = frame.time.value_or(0);
        shot.place = frame.place;
        shot.picture.path = find_picture(rig, frame.file_path, frame.place + ".file_path");
        shot.name = shot.picture.path.stem().string();
        if (shot.camera == first.size()) {
            first.push_back(&frame);
            RigCamera camera;
            camera.name = fmt::format("{}", shot.camera);
            camera.world_from_camera = frame.world_from_camera;
            camera.lens = make_lens(frame, shot.picture.path);
            if (!frame.background_path.empty())
                camera.plate.path = find_picture(rig, frame.background_path, frame.place + ".background_path");
            rig.cameras.push_back(std::move(camera));
        }
        if (frame.background_path != first[shot.camera]->background_path)
            throw InputError(rig.file, frame.place + ".background_path",
                             "differs from that of the same camera in " + first[shot.camera]->place,
                             "give one clean plate to all frames of a camera, or none");
        rig.shots.push_back(std::move(shot));
    }
}

void expect_times_of_all_or_none(const Rig& rig, const std::vector<TransformsFrame>& frames) {
    const bool timed = frames[0].time.has_value();
    for (const TransformsFrame& frame : frames)
        if (frame.time.has_value() != timed)
            throw InputError(rig.file, timed ? frame.place : frames[0].place, "has no time, but other frames have one",
                             "give it to all frames or none");
}

// Pictures of cameras in folders of their own are often named alike: then the folders belong to the names.
void tell_names_apart(Rig& rig) {
    std::set<std::string> names;
    for (const Shot& shot : rig.shots) names.insert(shot.name);
    if (names.size() == rig.shots.size()) return;
    for (Shot& shot : rig.shots) {
        shot.name =
            shot.picture.path.lexically_relative(rig.folder).lexically_normal().replace_extension().generic_string();
        std::replace(shot.name.begin(), shot.name.end(), '/', '_');
    }
}

}  // namespace

bool has_nerf_files(const std::filesystem::path& folder) {
    for (const char* name : {"transforms_train.json", "transforms_test.json", "transforms.json"})
        if (holds_file(folder / name)) return true;
    return false;
}

Rig read_nerf_rig(const std::filesystem::path& folder, Split split) {
    const auto [file, transforms] = read_split(folder, split);
    Rig rig;
    rig.folder = folder;
    rig.format = "nerf";
    rig.file = file.string();
    rig.box = transforms.box;
    rig.fps = transforms.fps;
    expect_times_of_all_or_none(rig, transforms.frames);
    add_cameras_and_shots(rig, transforms.frames);
    tell_names_apart(rig);
    return rig;
}

std::vector<CameraKey> load_camera_path(const std::filesystem::path& file) {
    std::vector<CameraKey> keys;
    for (const TransformsFrame& frame : read_transforms(file).frames) {
        const Intrinsics& in = frame.intrinsics;
        const bool sized = in.width != 0;
        if (!sized && (in.fl_x || in.fl_y || in.cx || in.cy))
            throw InputError(file.string(), frame.place,
                             "fl_x, fl_y, cx, cy are in pixels of a picture of unknown size",
                             "give w and h, or camera_angle_x alone");
        CameraKey key{make_camera(frame, in.width, in.height), frame.time};
        if (!sized) key.camera.fx = key.camera.fy = 0.5 / std::tan(0.5 * in.camera_angle_x.value());
        keys.push_back(key);
    }
    return keys;
}

}  // namespace neuvv
