#include "training/data/layouts/nerf_splits.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "training/data/layouts/rig/calibration.h"

namespace neuvv::training {

namespace {

// Frames are of the same camera where these numbers are equal: pose and intrinsics as the file gives them.
using CameraIdentity = std::vector<double>;

CameraIdentity identity(const interchange::TransformsFrame& frame) {
    constexpr double kAbsent = std::numeric_limits<double>::infinity();
    const interchange::Intrinsics& in = frame.intrinsics;
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

constexpr const char* kSplitNames[] = {"train", "test", "val"};  // by Split

const char* name_of(Split split) {
    return kSplitNames[static_cast<size_t>(split)];
}

std::string normal(const std::string& path) {
    return std::filesystem::path(path).lexically_normal().generic_string();
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
        interchange::Transforms transforms = interchange::read_transforms(file);
        if (result.file.empty()) {
            result.file = file;
            result.transforms = std::move(transforms);
        } else {
            for (interchange::TransformsFrame& frame : transforms.frames)
                result.transforms.frames.push_back(std::move(frame));
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
    result.transforms = interchange::read_transforms(result.file);
    // An image may be of two splits: often, those of the validation are those of the test.
    std::set<std::string> images;
    for (const interchange::TransformsFrame& frame : result.transforms.frames) images.insert(normal(frame.file_path));
    for (const char* other : kSplitNames) {
        const auto file = split_file(folder, other);
        if (file == result.file || !holds_file(file)) continue;
        for (interchange::TransformsFrame& frame : interchange::read_transforms(file).frames)
            if (images.insert(normal(frame.file_path)).second) result.other_frames.push_back(std::move(frame));
    }
    return result;
}

// Which frames are of the split by nerfstudio's lists. Those of the validation are often those of the test.
std::vector<bool> members_by_list(const std::string& file, const interchange::Transforms& all, Split split) {
    std::map<std::string, std::set<size_t>> lists_of;
    constexpr auto kTrainList = static_cast<size_t>(Split::kTrain);
    for (size_t s = 0; s < all.split_files.size(); ++s)
        for (const std::string& path : all.split_files[s].value_or(std::vector<std::string>())) {
            std::set<size_t>& lists = lists_of[normal(path)];
            if (s != kTrainList && lists.contains(kTrainList))
                throw InputError(file, fmt::format("{}_filenames", kSplitNames[s]),
                                 fmt::format("names {}, which is in {}_filenames, too", path, kSplitNames[kTrainList]),
                                 "keep training and test apart");
            lists.insert(s);
        }
    std::vector<bool> members;
    std::set<std::string> frames;
    for (const interchange::TransformsFrame& frame : all.frames) {
        const auto listed = lists_of.find(*frames.insert(normal(frame.file_path)).first);
        members.push_back(listed != lists_of.end() && listed->second.contains(static_cast<size_t>(split)));
    }
    for (const auto& [path, lists] : lists_of)
        if (!frames.contains(path))
            throw InputError(file, fmt::format("{}_filenames", kSplitNames[*lists.begin()]),
                             fmt::format("names {}, which is no file_path of a frame", path), "correct the list");
    if (std::find(members.begin(), members.end(), true) == members.end())
        throw InputError(file, fmt::format("{}_filenames", name_of(split)), "is missing or empty",
                         "name the images of that split");
    return members;
}

// Which frames are of the split where every 8th camera is held out for the test.
std::vector<bool> members_by_camera(const std::string& file, const interchange::Transforms& all, Split split) {
    if (split == Split::kVal)
        throw InputError(file, "", "has no validation split", "give val_filenames or transforms_val.json");
    const std::vector<uint32_t> cameras = number_cameras(all.frames);
    if (*std::max_element(cameras.begin(), cameras.end()) == 0)
        throw InputError(file, "frames", "has one camera, and one must be held out for the test",
                         Remedy::kMoreFilesOrHoldNone);
    std::vector<bool> members;
    for (const uint32_t camera : cameras) members.push_back((camera % kHoldOut == 0) == (split == Split::kTest));
    return members;
}

SplitFrames read_shared_file(const std::filesystem::path& folder, Split split) {
    SplitFrames result;
    result.file = folder / "transforms.json";
    interchange::Transforms& all = result.transforms = interchange::read_transforms(result.file);
    if (split == Split::kAll) return result;
    const bool listed =
        std::any_of(all.split_files.begin(), all.split_files.end(), [](const auto& list) { return list.has_value(); });
    const std::vector<bool> members = (listed ? members_by_list : members_by_camera)(result.file.string(), all, split);
    std::vector<interchange::TransformsFrame> kept;
    for (size_t i = 0; i < all.frames.size(); ++i) {
        (members[i] ? kept : result.other_frames).push_back(std::move(all.frames[i]));
    }
    all.frames = std::move(kept);
    return result;
}

}  // namespace

std::vector<uint32_t> number_cameras(const std::vector<interchange::TransformsFrame>& frames) {
    std::map<CameraIdentity, uint32_t> seen;
    std::vector<uint32_t> cameras;
    cameras.reserve(frames.size());
    for (const interchange::TransformsFrame& frame : frames)
        cameras.push_back(seen.try_emplace(identity(frame), static_cast<uint32_t>(seen.size())).first->second);
    return cameras;
}

bool holds_file(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::exists(file, ignored);
}

bool has_split_files(const std::filesystem::path& folder) {
    return std::ranges::any_of(kSplitNames, [&](const char* name) { return holds_file(split_file(folder, name)); });
}

bool has_nerf_validation(const std::filesystem::path& folder) {
    if (has_split_files(folder)) return holds_file(split_file(folder, name_of(Split::kVal)));
    const auto& listed =
        interchange::read_transforms(folder / "transforms.json").split_files[static_cast<size_t>(Split::kVal)];
    return listed && !listed->empty();
}

bool is_split_file(const std::filesystem::path& folder, const std::filesystem::path& file) {
    return std::ranges::any_of(kSplitNames, [&](const char* name) { return file == split_file(folder, name); });
}

SplitFrames read_split(const std::filesystem::path& folder, Split split) {
    return has_split_files(folder) ? read_file_of_split(folder, split) : read_shared_file(folder, split);
}

}  // namespace neuvv::training
