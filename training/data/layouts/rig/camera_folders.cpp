#include "training/data/layouts/rig/camera_folders.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/clip_times.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

namespace {

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

void leave_out(Rig& rig, const std::vector<MissingImage>& missing, size_t listed) {
    if (missing.empty()) return;
    const MissingImage& first = missing[0];
    if (2 * missing.size() > listed)
        throw InputError(rig.file, first.place,
                         fmt::format("there is no image {}, and {} of {} images are missing", first.path.string(),
                                     missing.size(), listed),
                         "put them there or correct the paths");
    rig.remarks.push_back(fmt::format("{} of {} images are not there, and are left out: {}{}", missing.size(), listed,
                                      first.path.lexically_normal().lexically_relative(rig.folder).string(),
                                      missing.size() > 1 ? " and others" : ""));
}

void note_choices(Rig& rig, const std::vector<CameraFrames>& cameras) {
    std::string read, other;  // of the first camera with images in two places
    size_t count = 0;
    const Choice images = images_folder(rig.folder);
    bool from_images = false;
    for (const CameraFrames& camera : cameras) {
        if (camera.frames.empty()) continue;
        const ImageSource& first = camera.frames.begin()->second;
        const auto used = first.video_frame < 0 ? first.path.parent_path() : first.path;
        from_images |= first.path.string().starts_with(images.path.string() + "/");
        for (const auto& place : places_of_camera(rig.folder, camera.camera.name)) {
            if (place == used || count++ > 0) continue;
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
    for (const auto& folder : masks_folders(rig.folder)) found.push_back(folder.filename().string() + "/");
    if (found.size() > 1) rig.remarks.push_back(choice_remark(found[0], {found.begin() + 1, found.end()}));
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

void pair_by_order(Rig& rig, std::vector<CalibratedCamera>& cameras) {
    for (const CalibratedCamera& from : cameras) expect_inside(from.camera.name, rig.file, from.place);
    if (std::ranges::any_of(cameras, [&](const auto& from) { return has_images(rig.folder, from.camera.name); }))
        return;
    const NamesOfImages found = names_of_images(rig.folder);
    if (found.names.empty()) return;
    if (found.names.size() != cameras.size())
        throw InputError(rig.file, "",
                         fmt::format("has {} cameras, but {} has the images of {}, none of which bears the name of one",
                                     cameras.size(), found.folder, found.names.size()),
                         "name them after the cameras, or give one for each");
    for (size_t i = 0; i < cameras.size(); ++i) {
        rig.remarks.push_back(fmt::format("camera {}: {}, by their order", cameras[i].camera.name, found.places[i]));
        cameras[i].camera.name = found.names[i];
    }
}

namespace {

[[noreturn]] void fail_without_images(const Rig& rig, const std::vector<CalibratedCamera>& calibrated) {
    std::vector<std::string> names;
    for (const CalibratedCamera& from : calibrated) names.push_back(from.camera.name);
    std::string found = entries_text(rig.folder);
    std::error_code ignored;
    for (const auto& folder : {images_folder(rig.folder).path, rig.folder / "videos"})
        if (std::filesystem::is_directory(folder, ignored))
            found += fmt::format("; {}/ holds {}", folder.filename().string(), entries_text(folder));
    throw InputError(rig.folder.string(), "",
                     fmt::format("holds no image of any camera of {} ({}): it holds {}",
                                 std::filesystem::path(rig.file).filename().string(), first_names(names), found),
                     "put .png or .jpg files into images/<camera>/, or give videos/<camera>.mp4");
}

}  // namespace

std::vector<CameraFrames> find_images(Rig& rig, std::vector<CalibratedCamera> calibrated) {
    pair_by_order(rig, calibrated);
    const std::filesystem::path masks = masks_folder(rig.folder);
    std::vector<CameraFrames> cameras;
    std::set<std::string> seen;
    for (const CalibratedCamera& from : calibrated) {
        const std::string& name = from.camera.name;
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
    if (cameras.empty()) fail_without_images(rig, calibrated);
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
