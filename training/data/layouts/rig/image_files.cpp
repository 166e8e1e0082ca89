#include "training/data/layouts/rig/image_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <span>

#include "base/error.h"
#include "base/text.h"
#include "media/video.h"
#include "training/data/layouts/rig/candidates.h"

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

// The videos <camera>.*, else those whose names end in _<camera>.
std::vector<std::filesystem::path> videos_of(const std::filesystem::path& folder, const std::string& camera) {
    if (auto path = find_file(folder, camera, kVideoEndings); !path.empty()) return {path};
    std::vector<std::filesystem::path> found;
    for (const auto& entry : entries_of(folder))
        if (is_video(entry) && entry.stem().string().ends_with("_" + camera)) found.push_back(entry);
    return found;
}

// Throws InputError where several videos have the camera's name.
std::filesystem::path one_video(const std::vector<std::filesystem::path>& videos, const std::string& camera) {
    if (videos.size() > 1)
        throw InputError(videos[1].string(), "",
                         fmt::format("is named after the camera {}, as is {}", camera, videos[0].filename().string()),
                         "keep one video a camera");
    return videos.empty() ? std::filesystem::path() : videos[0];
}

// The folders in which a data set may have a folder of images for each camera.
std::vector<std::filesystem::path> image_folders(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> folders = {images_folder(folder).path};
    for (const char* name : {"hdImgs", "vgaImgs", "kinectImgs", "rgbs"}) folders.push_back(folder / name);
    folders.push_back(folder);
    return folders;
}

std::vector<std::filesystem::path> video_folders(const std::filesystem::path& folder) {
    return {folder / "videos", folder / "hdVideos", folder / "vgaVideos", folder / "kinectVideos", folder};
}

// The frames without the camera's name, where all their names begin with it, and without a word behind it: "00_03_0017"
// of the camera 00_03 becomes "0017", and so does "Cam001_rgb0017" of Cam001.
Frames without_camera(const Frames& frames, const std::string& camera) {
    if (frames.empty()) return frames;
    const std::string name = std::filesystem::path(camera).filename().string() + "_", &first = frames.begin()->first;
    size_t length = name.size();
    while (length < first.size() && !is_digit(first[length])) ++length;
    if (length >= first.size()) length = name.size();  // no number: only the camera's name is left out
    const std::string beginning = first.substr(0, length);
    Frames shorter;
    for (const auto& [whole, image] : frames) {
        if (!whole.starts_with(name) || !whole.starts_with(beginning) || whole.size() == length) return frames;
        shorter[whole.substr(length)] = image;
    }
    return shorter;
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

std::vector<std::filesystem::path> places_of_camera(const std::filesystem::path& folder, const std::string& camera) {
    std::vector<std::filesystem::path> places;
    for (const auto& parent : image_folders(folder))
        if (!images_in(parent / camera).empty()) places.push_back(parent / camera);
    for (const auto& parent : video_folders(folder))
        for (const auto& video : videos_of(parent, camera)) places.push_back(video);
    return places;
}

Frames frames_of_camera(const std::filesystem::path& folder, const std::string& camera) {
    for (const auto& parent : image_folders(folder))
        if (const Frames frames = images_in(parent / camera); !frames.empty()) return without_camera(frames, camera);
    for (const auto& parent : video_folders(folder))
        if (const auto video = one_video(videos_of(parent, camera), camera); !video.empty())
            return frames_of_video(video);
    return {};
}

Frames still_in(const std::filesystem::path& folder, const std::string& camera) {
    const std::filesystem::path file = find_file(folder, camera, kImageEndings);
    return file.empty() ? Frames() : Frames{{kOnlyFrame, ImageSource{file, -1}}};
}

Frames still_of_camera(const std::filesystem::path& folder, const std::string& camera) {
    Frames still = still_in(images_folder(folder).path, camera);
    return still.empty() ? still_in(folder, camera) : still;
}

bool has_images(const std::filesystem::path& folder, const std::string& camera) {
    return !places_of_camera(folder, camera).empty() || !still_of_camera(folder, camera).empty();
}

ImageSource image_or_video(const std::filesystem::path& folder, const std::string& name) {
    if (const auto image = find_file(folder, name, kImageEndings); !image.empty()) return {image, -1};
    const auto video = one_video(videos_of(folder, name), name);
    return video.empty() ? ImageSource() : ImageSource{video, 0};
}

NamesOfImages names_of_images(const std::filesystem::path& folder) {
    const auto in = [&](const std::filesystem::path& parent, bool videos) {
        std::set<std::string, NaturalOrder> names;
        if (parent == folder) return NamesOfImages();  // which holds much else
        for (const auto& entry : entries_of(parent))
            if (videos ? is_video(entry) : !images_in(entry).empty())
                names.insert(videos ? entry.stem().string() : entry.filename().string());
        NamesOfImages found{parent.filename().string() + "/", {names.begin(), names.end()}, {}};
        for (const std::string& name : names) found.places.push_back(found.folder + name + (videos ? ".*" : "/"));
        return found;
    };
    for (const bool videos : {false, true})
        for (const auto& parent : videos ? video_folders(folder) : image_folders(folder))
            if (NamesOfImages found = in(parent, videos); !found.names.empty()) return found;
    return {};
}

std::filesystem::path first_folder(const std::filesystem::path& folder, std::initializer_list<const char*> names) {
    std::error_code ignored;
    for (const char* name : names)
        if (std::filesystem::is_directory(folder / name, ignored)) return folder / name;
    return {};
}

std::vector<std::filesystem::path> masks_folders(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> found;
    for (const char* name : {"masks", "mask", "mask_cihp", "bgmtv2", "msk"})
        if (const auto masks = first_folder(folder, {name}); !masks.empty()) found.push_back(masks);
    return found;
}

std::filesystem::path masks_folder(const std::filesystem::path& folder) {
    const std::vector<std::filesystem::path> found = masks_folders(folder);
    return found.empty() ? std::filesystem::path() : found[0];
}

std::string without_extension(const std::string& name) {
    const std::filesystem::path path(name);
    const std::string extension = lower_extension(path);
    const bool other = extension == ".tif" || extension == ".tiff" || extension == ".exr" || extension == ".dng";
    return other || is_image(path) || is_video(path) ? name.substr(0, name.size() - extension.size()) : name;
}

Frames masks_of_camera(const std::filesystem::path& masks, const std::string& camera, const Frames& frames) {
    const Frames found = images_in(masks / camera), by_frame = without_camera(found, camera);
    if (found.empty()) {
        const auto video = one_video(videos_of(masks, camera), camera);
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
        auto mask = by_frame.find(name);
        const bool as_frame = mask != by_frame.end();
        if (!as_frame) mask = found.find(image.path.filename().string());  // COLMAP's "a.jpg.png"
        if (!as_frame && mask == found.end())
            throw InputError((masks / camera).string(), "", fmt::format("has no mask {}.png", name),
                             "give every frame its mask, named as the image");
        result[name] = mask->second;
    }
    return result;
}

}  // namespace neuvv::training
