#include "training/data/layouts/rig/camera_folders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <span>

#include "base/error.h"
#include "base/text.h"
#include "media/video.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/clip_times.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

namespace {

constexpr const char* kImageEndings[] = {".png", ".jpg", ".jpeg"};
constexpr const char* kVideoEndings[] = {".mp4", ".mkv", ".mov",  ".avi", ".webm", ".m4v", ".mts", ".m2ts",
                                         ".ts",  ".mpg", ".mpeg", ".mxf", ".wmv",  ".3gp", ".ogv", ".flv"};

bool is_digit(char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

// The digits at `at` without leading zeros; moves `at` behind them.
std::string_view take_digits(const std::string& text, size_t& at) {
    const size_t begin = at;
    while (at < text.size() && is_digit(text[at])) ++at;
    std::string_view digits = std::string_view(text).substr(begin, at - begin);
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
}

std::string lower_extension(const std::filesystem::path& path) {
    return lower_case(path.extension().string());
}

bool is_image(const std::filesystem::path& path) {
    return std::ranges::find(kImageEndings, lower_extension(path)) != std::end(kImageEndings);
}

std::string upper_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

// The file of this name with this ending, in whatever letters the ending is written.
std::filesystem::path find_file(const std::filesystem::path& folder, const std::string& stem,
                                const std::string& ending) {
    std::error_code ignored;
    for (const std::string& as_written : {ending, upper_case(ending)})
        if (auto path = folder / (stem + as_written); std::filesystem::is_regular_file(path, ignored)) return path;
    return {};
}

// The file of this name with one of these endings. Throws InputError where there are two.
std::filesystem::path find_file(const std::filesystem::path& folder, const std::string& stem,
                                std::span<const char* const> endings) {
    std::filesystem::path found;
    for (const char* ending : endings) {
        const std::filesystem::path file = find_file(folder, stem, ending);
        if (!file.empty() && !found.empty())
            throw InputError(file.string(), "", fmt::format("is named like {}", found.filename().string()),
                             "keep the one that counts");
        if (!file.empty()) found = file;
    }
    if (!found.empty()) return found;
    for (const auto& entry : entries_of((folder / stem).parent_path()))  // as ".Mp4"
        if (entry.stem() == std::filesystem::path(stem).filename() &&
            std::ranges::find(endings, lower_extension(entry)) != endings.end())
            return entry;
    return {};
}

// The video <camera>.*, else the one whose name ends in _<camera>.
std::filesystem::path find_video(const std::filesystem::path& folder, const std::string& camera) {
    if (auto path = find_file(folder, camera, kVideoEndings); !path.empty()) return path;
    std::filesystem::path found;
    for (const auto& entry : entries_of(folder)) {
        if (!is_video(entry) || !entry.stem().string().ends_with("_" + camera)) continue;
        if (!found.empty())
            throw InputError(entry.string(), "",
                             fmt::format("is named after the camera {}, as is {}", camera, found.filename().string()),
                             "keep one video a camera");
        found = entry;
    }
    return found;
}

Frames still_in(const std::filesystem::path& folder, const std::string& camera) {
    const std::filesystem::path file = find_file(folder, camera, kImageEndings);
    return file.empty() ? Frames() : Frames{{kOnlyFrame, ImageSource{file, -1}}};
}

Frames still_of_camera(const std::filesystem::path& folder, const std::string& camera) {
    Frames still = still_in(images_folder(folder).path, camera);
    return still.empty() ? still_in(folder, camera) : still;
}

// The time of each frame's name.
std::map<std::string, double, NaturalOrder> times_of(const std::vector<CameraFrames>& cameras) {
    std::map<std::string, double, NaturalOrder> times;
    for (const CameraFrames& from : cameras)
        for (const auto& [name, image] : from.frames) times.try_emplace(name, 0);
    const double last = std::max(1.0, static_cast<double>(times.size()) - 1);
    double next = 0;
    for (auto& [name, time] : times) time = next++ / last;
    return times;
}

}  // namespace

bool NaturalOrder::operator()(const std::string& a, const std::string& b) const {
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const std::string_view x = take_digits(a, i), y = take_digits(b, j);
            if (x.size() != y.size()) return x.size() < y.size();
            if (x != y) return x < y;
        } else {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i, ++j;
        }
    }
    const size_t a_left = a.size() - i, b_left = b.size() - j;
    return a_left != b_left ? a_left < b_left : a < b;  // the last comparison tells "1" from "01"
}

Frames images_in(const std::filesystem::path& folder) {
    Frames frames;
    for (const auto& entry : entries_of(folder)) {
        if (!is_image(entry)) continue;
        const auto [same, fresh] = frames.try_emplace(entry.stem().string(), ImageSource{entry, -1});
        if (!fresh)
            throw InputError(entry.string(), "", fmt::format("is named like {}", same->second.path.filename().string()),
                             "keep one image a frame");
    }
    return frames;
}

bool is_video(const std::filesystem::path& path) {
    return std::ranges::find(kVideoEndings, lower_extension(path)) != std::end(kVideoEndings);
}

Frames frames_of_video(const std::filesystem::path& path) {
    const media::VideoReader video(path);
    Frames frames;
    for (uint32_t i = 0; i < video.frames(); ++i) frames[fmt::format("{:06}", i)] = {path, i};
    return frames;
}

Frames frames_of_camera(const std::filesystem::path& folder, const std::string& camera) {
    for (const auto& candidate : {images_folder(folder).path / camera, folder / camera})
        if (Frames frames = images_in(candidate); !frames.empty()) return frames;
    for (const auto& candidate : {folder / "videos", folder})
        if (const auto video = find_video(candidate, camera); !video.empty()) return frames_of_video(video);
    return {};
}

bool has_images(const std::filesystem::path& folder, const std::string& camera) {
    for (const auto& candidate : {images_folder(folder).path / camera, folder / camera})
        if (!images_in(candidate).empty()) return true;
    for (const auto& candidate : {folder / "videos", folder})
        if (!find_video(candidate, camera).empty()) return true;
    return !still_of_camera(folder, camera).empty();
}

ImageSource image_or_video(const std::filesystem::path& folder, const std::string& name) {
    if (const auto image = find_file(folder, name, kImageEndings); !image.empty()) return {image, -1};
    const auto video = find_video(folder, name);
    return video.empty() ? ImageSource() : ImageSource{video, 0};
}

std::vector<std::string> videos_in(const std::filesystem::path& folder) {
    std::set<std::string, NaturalOrder> names;
    for (const auto& entry : entries_of(folder))
        if (is_video(entry)) names.insert(entry.stem().string());
    return {names.begin(), names.end()};
}

std::filesystem::path first_folder(const std::filesystem::path& folder, std::initializer_list<const char*> names) {
    std::error_code ignored;
    for (const char* name : names)
        if (std::filesystem::is_directory(folder / name, ignored)) return folder / name;
    return {};
}

void note_choices(Rig& rig, const std::vector<CameraFrames>& cameras) {
    std::string read, other;  // of the first camera with images in two places
    size_t count = 0;
    const Choice images = images_folder(rig.folder);
    bool from_images = false;
    for (const CameraFrames& camera : cameras) {
        if (camera.frames.empty()) continue;
        const ImageSource& first = camera.frames.begin()->second;
        const std::string& name = camera.camera.name;
        const auto used = first.video_frame < 0 ? first.path.parent_path() : first.path;
        from_images |= first.path.string().starts_with(images.path.string() + "/");
        for (const auto& place :
             {images.path / name, rig.folder / name, find_file(rig.folder / "videos", name, kVideoEndings),
              find_file(rig.folder, name, kVideoEndings)}) {
            if (place.empty() || place == used || (!is_video(place) && images_in(place).empty())) continue;
            if (count++ > 0) continue;
            read = used.lexically_relative(rig.folder).string();
            other = place.lexically_relative(rig.folder).string();
        }
    }
    if (count > 0)
        rig.remarks.push_back(choice_remark(read, {other}) +
                              (count > 1 ? fmt::format(", and alike in {} cases", count) : ""));
    if (from_images && !images.remark.empty()) rig.remarks.push_back(images.remark);
}

void note_mask_folders(Rig& rig) {
    std::vector<std::string> found;
    std::error_code ignored;
    for (const char* name : {"masks", "mask", "mask_cihp"})
        if (std::filesystem::is_directory(rig.folder / name, ignored)) found.push_back(std::string(name) + "/");
    if (found.size() > 1) rig.remarks.push_back(choice_remark(found[0], {found.begin() + 1, found.end()}));
}

std::filesystem::path masks_folder(const std::filesystem::path& folder) {
    return first_folder(folder, {"masks", "mask", "mask_cihp"});
}

std::string without_extension(const std::string& name) {
    const std::filesystem::path path(name);
    const std::string extension = lower_extension(path);
    const bool other = extension == ".tif" || extension == ".tiff" || extension == ".exr" || extension == ".dng";
    return other || is_image(path) || is_video(path) ? name.substr(0, name.size() - extension.size()) : name;
}

Frames masks_of_camera(const std::filesystem::path& masks, const std::string& camera, const Frames& frames) {
    Frames found = images_in(masks / camera);
    if (found.empty()) {
        const auto video = find_video(masks, camera);
        if (video.empty())
            throw InputError((masks / camera).string(), "", "holds no masks",
                             "give every camera masks, or take the masks' folder away");
        Frames in_order;
        const Frames of_video = frames_of_video(video);
        if (of_video.size() != frames.size())
            throw InputError(video.string(), "",
                             fmt::format("has {} frames, but its camera {}", of_video.size(), frames.size()),
                             "give every frame its mask");
        auto mask = of_video.begin();
        for (const auto& [name, image] : frames) in_order[name] = (mask++)->second;
        return in_order;
    }
    Frames result;
    for (const auto& [name, image] : frames) {
        auto mask = found.find(name);
        if (mask == found.end()) mask = found.find(image.path.filename().string());  // COLMAP's "a.jpg.png"
        if (mask == found.end())
            throw InputError((masks / camera).string(), "", fmt::format("has no mask {}.png", name),
                             "give every frame its mask, named as the image");
        result[name] = mask->second;
    }
    return result;
}

void name_by_time(Rig& rig, std::vector<CameraFrames>& cameras) {
    std::vector<ClipVideo> videos;
    std::vector<CameraFrames*> with_video;
    for (CameraFrames& camera : cameras) {
        if (camera.frames.empty() || camera.frames.begin()->second.video_frame < 0) continue;
        const std::filesystem::path& path = camera.frames.begin()->second.path;
        videos.push_back({camera.camera.name, path, media::video_times(path)});
        with_video.push_back(&camera);
    }
    if (videos.empty()) return;
    const ClipTimes clip = clip_times(videos);
    rig.fps = clip.fps;
    for (size_t v = 0; v < with_video.size(); ++v) {
        Frames frames, masks;
        for (const auto& [name, image] : with_video[v]->frames) {
            const auto frame = static_cast<size_t>(image.video_frame);
            if (frame >= clip.frames[v].size() || clip.frames[v][frame] == kNotInClip) continue;
            const std::string moment = fmt::format("{:06}", clip.frames[v][frame]);
            frames[moment] = image;
            if (const auto mask = with_video[v]->masks.find(name); mask != with_video[v]->masks.end())
                masks[moment] = mask->second;
        }
        with_video[v]->frames = std::move(frames);
        with_video[v]->masks = std::move(masks);
    }
    rig.remarks.insert(rig.remarks.end(), clip.remarks.begin(), clip.remarks.end());
    add_remarks(rig, clip.texts);
}

std::vector<CameraFrames> find_images(Rig& rig, const std::vector<CalibratedCamera>& calibrated) {
    const std::filesystem::path masks = masks_folder(rig.folder);
    std::vector<CameraFrames> cameras;
    std::set<std::string> seen;
    for (const CalibratedCamera& from : calibrated) {
        const std::string& name = from.camera.name;
        expect_inside(name, rig.file, from.place);
        if (!seen.insert(name).second)
            throw InputError(rig.file, from.place, fmt::format("is another camera of the name {}", name),
                             "give each camera its own name");
        CameraFrames camera{from.camera, from.place, cameras.size(), frames_of_camera(rig.folder, name), {}};
        const bool still = camera.frames.empty();
        if (still) camera.frames = still_of_camera(rig.folder, name);
        if (camera.frames.empty()) continue;
        const ImageSource& first = camera.frames.begin()->second;
        fit_to_images(camera.camera, first, rig, from.place);
        if (!masks.empty()) {
            if (still) camera.masks = still_in(masks, name);
            if (still && camera.masks.empty()) camera.masks = still_in(masks, first.path.filename().string());
            if (camera.masks.empty()) camera.masks = masks_of_camera(masks, name, camera.frames);
        }
        cameras.push_back(std::move(camera));
    }
    if (cameras.empty())
        throw InputError(rig.folder.string(), "", fmt::format("holds no image of any camera of {}", rig.file),
                         "put them into images/<camera>/ or videos/<camera>.mp4");
    name_by_time(rig, cameras);
    if (cameras.size() < calibrated.size())
        rig.remarks.push_back(fmt::format("{} of {} calibrated cameras have no images, and are left out",
                                          calibrated.size() - cameras.size(), calibrated.size()));
    expect_common_frames(rig, cameras);
    note_choices(rig, cameras);
    note_mask_folders(rig);
    return cameras;
}

void expect_common_frames(const Rig& rig, const std::vector<CameraFrames>& cameras) {
    size_t frames = 0;
    for (const CameraFrames& from : cameras) frames += from.frames.size();
    if (cameras.size() > 1 && times_of(cameras).size() == frames)
        throw InputError(rig.folder.string(), "", "no image of one camera is named as one of another",
                         "give images of the same time the same name: images/<camera>/000000.jpg");
}

void add_cameras(Rig& rig, const std::vector<CameraFrames>& cameras, Split split) {
    const std::map<std::string, double, NaturalOrder> times = times_of(cameras);
    const bool all = split == Split::kAll;
    if (!all && std::ranges::all_of(cameras, [&](const auto& c) { return c.group == cameras[0].group; }))
        throw InputError(rig.file, "", "has one camera with images, and one must be held out for the test",
                         Remedy::kMoreCamerasOrHoldNone);
    for (const CameraFrames& from : cameras) {
        rig.poses.push_back(from.camera.world_from_camera);
        if (!all && (from.group % kHoldOut == 0) != (split == Split::kTest)) continue;
        const auto camera = static_cast<uint32_t>(rig.cameras.size());
        rig.cameras.push_back(from.camera);
        for (const auto& [name, image] : from.frames) {
            Shot shot{camera,
                      times.at(name),
                      from.camera.name + "_" + name,
                      fmt::format("{}, frame {}", from.place, name),
                      image,
                      {}};
            std::replace(shot.name.begin(), shot.name.end(), '/', '_');
            if (!from.masks.empty()) shot.mask = from.masks.at(name);
            rig.shots.push_back(std::move(shot));
        }
    }
}

}  // namespace neuvv::training
