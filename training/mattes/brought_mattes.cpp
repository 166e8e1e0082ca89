#include "training/mattes/brought_mattes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"

namespace neuvv::training {

namespace {

namespace fs = std::filesystem;

constexpr const char* kMatteEndings[] = {".png", ".PNG", ".jpg", ".JPG", ".jpeg", ".JPEG"};
constexpr const char* kMatteVideoEndings[] = {".mov", ".webm", ".mkv", ".mp4"};

// The paths of all files in a folder and below it, relative to it.
std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> files;
    std::error_code error;
    fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
    if (error) throw InputError(folder.string(), "", "is no folder that can be read", "name the folder of the mattes");
    for (; entry != end; entry.increment(error)) {
        if (error) break;
        if (entry->is_regular_file(error)) files.insert(entry->path().lexically_relative(folder).generic_string());
    }
    return files;
}

// The path without its first folder.
fs::path without_first(const fs::path& path) {
    fs::path rest;
    for (auto part = std::next(path.begin()); part != path.end(); ++part) rest /= *part;
    return rest;
}

// What the matte of a shot may be called, the likeliest first, without the ending of its format.
std::vector<std::string> names_of(const Rig& rig, const Shot& shot) {
    std::vector<std::string> names{shot.name};
    if (shot.image.video_frame >= 0) return names;
    fs::path path = shot.image.path.lexically_relative(rig.folder);
    if (path.empty() || *path.begin() == "..") path = shot.image.path.filename();
    const std::string stem = path.stem().string(), camera = rig.cameras[shot.camera].name;
    for (; !path.empty(); path = without_first(path)) {
        if (!path.has_parent_path())
            for (const char* joint : {"/", "_", "-"}) names.push_back(fmt::format("{}{}{}", camera, joint, stem));
        names.push_back(fs::path(path).replace_extension().generic_string());
        names.push_back(path.generic_string());
    }
    return names;
}

std::string find_image(const std::set<std::string>& files, const std::vector<std::string>& names) {
    for (const std::string& name : names)
        for (const char* ending : kMatteEndings)
            if (files.contains(name + ending)) return name + ending;
    return "";
}

// The place in time of each shot among those of its camera.
std::vector<int64_t> places_in_time(const Rig& rig) {
    std::vector<std::vector<uint32_t>> of_camera(rig.cameras.size());
    for (uint32_t i = 0; i < rig.shots.size(); ++i) of_camera[rig.shots[i].camera].push_back(i);
    std::vector<int64_t> places(rig.shots.size());
    for (std::vector<uint32_t>& shots : of_camera) {
        std::ranges::stable_sort(shots, {}, [&](uint32_t i) { return rig.shots[i].time; });
        for (size_t place = 0; place < shots.size(); ++place) places[shots[place]] = static_cast<int64_t>(place);
    }
    return places;
}

ImageSource find_matte(const fs::path& folder, const std::set<std::string>& files, const Rig& rig, const Shot& shot,
                       int64_t place_in_time) {
    if (const std::string name = find_image(files, names_of(rig, shot)); !name.empty()) return {folder / name, -1};
    for (const char* ending : kMatteVideoEndings)
        if (const std::string name = rig.cameras[shot.camera].name + ending; files.contains(name))
            return {folder / name, shot.image.video_frame >= 0 ? shot.image.video_frame : place_in_time};
    throw InputError(
        folder.string(), shot.name, fmt::format("there is no matte {}.png", shot.name),
        "name mattes as their images, in folders by camera or not, or give a video named after its camera");
}

std::string text_of(const ImageSource& image) {
    return image.video_frame < 0 ? image.path.string()
                                 : fmt::format("{}: frame {}", image.path.string(), image.video_frame);
}

}  // namespace

std::vector<std::vector<ImageSource>> find_brought_mattes(const fs::path& folder, const std::vector<Rig>& rigs) {
    const std::set<std::string> files = files_in(folder);
    std::map<std::pair<fs::path, int64_t>, const ImageSource*> used;  // the image of each matte
    std::vector<std::vector<ImageSource>> mattes;
    for (const Rig& rig : rigs) {
        std::vector<ImageSource>& of_rig = mattes.emplace_back();
        const std::vector<int64_t> places = places_in_time(rig);
        for (size_t i = 0; i < rig.shots.size(); ++i) {
            const ImageSource& image = rig.shots[i].image;
            const ImageSource matte = find_matte(folder, files, rig, rig.shots[i], places[i]);
            const auto [other, fresh] = used.try_emplace({matte.path, matte.video_frame}, &image);
            if (!fresh && (other->second->path != image.path || other->second->video_frame != image.video_frame))
                throw InputError(
                    text_of(matte), "",
                    fmt::format("would be the matte of {} and of {}", text_of(*other->second), text_of(image)),
                    "put mattes into folders named after their cameras");
            of_rig.push_back(matte);
        }
    }
    return mattes;
}

}  // namespace neuvv::training
