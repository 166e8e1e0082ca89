#include "training/data/layouts/loaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/formats/npy.h"
#include "media/image.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/candidates.h"

namespace neuvv::training {

namespace {

constexpr size_t kRow = 17;  // 3×5 and two depths
constexpr double kOrthonormalTolerance = 1e-3;

std::filesystem::path poses_file(const std::filesystem::path& folder) {
    return folder / "poses_bounds.npy";
}

// The videos cam*.mp4 (or with another ending) in the order of their names, which is that of the rows.
std::vector<std::filesystem::path> find_videos(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> videos = entries_of(folder);
    std::erase_if(videos,
                  [](const auto& entry) { return !entry.filename().string().starts_with("cam") || !is_video(entry); });
    return videos;
}

// Adds a remark for other poses beside poses_bounds.npy: poses_bounds_multipleview.npy, poses.npy …
void note_other_poses(Rig& rig) {
    std::vector<std::string> others;
    for (const auto& entry : entries_of(rig.folder))
        if (entry != poses_file(rig.folder) && entry.extension() == ".npy" &&
            entry.filename().string().starts_with("poses"))
            others.push_back(entry.filename().string());
    if (!others.empty()) rig.remarks.push_back(choice_remark("poses_bounds.npy", others));
}

// The camera of a row: camera to world with columns [down, right, backwards, position], then a column (H, W, focal).
RigCamera make_camera(const double* row, const std::filesystem::path& video, const std::string& file,
                      const std::string& place) {
    const auto column = [&](int c) { return glm::dvec3(row[c], row[5 + c], row[10 + c]); };
    const glm::dmat3 axes(column(1), -column(0), column(2));
    const glm::dvec3 size = column(4);
    const glm::dmat3 off = glm::transpose(axes) * axes - glm::dmat3(1);  // 0 where the axes are orthonormal
    if (!(glm::length(off[0]) + glm::length(off[1]) + glm::length(off[2]) < kOrthonormalTolerance &&
          glm::determinant(axes) > 0))
        throw InputError(file, place, "is not a rigid pose", "give [down, right, backwards, position, (H, W, focal)]");
    if (!(size.x >= 1 && size.y >= 1 && size.x <= media::kMaxImageSide && size.y <= media::kMaxImageSide))
        throw InputError(file, place, fmt::format("says {}×{}, not an image size", size.y, size.x));
    RigCamera camera;
    camera.name = video.stem().string();
    camera.world_from_camera =
        glm::dmat4(glm::dvec4(axes[0], 0), glm::dvec4(axes[1], 0), glm::dvec4(axes[2], 0), glm::dvec4(column(3), 1));
    camera.lens.fx = camera.lens.fy = size.z;
    camera.lens.cx = 0.5 * size.y;
    camera.lens.cy = 0.5 * size.x;
    camera.lens.width = static_cast<uint32_t>(std::lround(size.y));
    camera.lens.height = static_cast<uint32_t>(std::lround(size.x));
    expect_sound(camera, file, place);
    return camera;
}

// `times` are of all moments of the clip, by their names.
void add_shots(Rig& rig, uint32_t camera, const Frames& frames, const std::map<std::string, double>& times) {
    for (const auto& [moment, image] : frames) {
        Shot shot;
        shot.camera = camera;
        shot.time = times.at(moment);
        shot.name = fmt::format("{}_f{:04}", rig.cameras[camera].name, std::stoll(moment));
        shot.place = fmt::format("{}, frame {}", image.path.filename().string(), image.video_frame);
        shot.image = image;
        rig.shots.push_back(shot);
    }
}

// The i-th of N moments that a video shows has the time i/(N−1).
std::map<std::string, double> times_by_moment(const std::vector<CameraFrames>& cameras) {
    std::map<std::string, double> times;
    for (const CameraFrames& camera : cameras)
        for (const auto& [moment, image] : camera.frames) times[moment] = 0;
    double next = 0;
    for (auto& [moment, time] : times) time = next++ / std::max(1.0, static_cast<double>(times.size()) - 1);
    return times;
}

}  // namespace

bool has_n3v_files(const std::filesystem::path& folder) {
    std::error_code ignored;
    return std::filesystem::exists(poses_file(folder), ignored);
}

Rig read_n3v_rig(const std::filesystem::path& folder, Split split) {
    Rig rig;
    rig.folder = folder;
    rig.format = "n3v";
    rig.world = "the unit and the axes of the structure from motion, not turned";
    rig.file = poses_file(folder).string();
    note_other_poses(rig);
    const NpyArray poses = read_npy(poses_file(folder));
    if (poses.shape.size() != 2 || poses.shape[1] != kRow)
        throw InputError(rig.file, "header", fmt::format("is not an array of N×{} numbers", kRow),
                         "give a row of 3×5 pose and two depths for each camera");
    const std::vector<std::filesystem::path> videos = find_videos(folder);
    if (videos.size() != poses.shape[0])
        throw InputError(
            rig.file, "",
            fmt::format("has {} rows, but beside it lie {} videos cam*.mp4", poses.shape[0], videos.size()),
            "give each row its video: rows are in order of the videos' names");
    if (videos.size() < 2 && split != Split::kAll)
        throw InputError(rig.file, "", "has one camera, and the first is held out for the test",
                         Remedy::kMoreCamerasOrHoldNone);
    std::vector<CameraFrames> cameras;
    for (size_t i = 0; i < videos.size(); ++i) {
        const std::string place = fmt::format("row {}", i);
        cameras.push_back({make_camera(&poses.values[i * kRow], videos[i], rig.file, place),
                           place,
                           i,
                           frames_of_video(videos[i]),
                           {}});
        fit_to_images(cameras[i].camera, {videos[i], 0}, rig, place);
    }
    name_by_time(rig, cameras);
    const std::map<std::string, double> times = times_by_moment(cameras);
    for (const CameraFrames& camera : cameras) {
        rig.poses.push_back(camera.camera.world_from_camera);
        if (split != Split::kAll && (camera.group == 0) != (split == Split::kTest)) continue;
        rig.cameras.push_back(camera.camera);
        add_shots(rig, static_cast<uint32_t>(rig.cameras.size() - 1), camera.frames, times);
    }
    return rig;
}

}  // namespace neuvv::training
