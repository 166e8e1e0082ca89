#include "training/layouts/n3v.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/npy.h"
#include "media/video.h"
#include "training/layouts/calibration.h"
#include "training/layouts/camera_folders.h"

namespace neuvv::training {

namespace {

constexpr size_t kRow = 17;  // 3×5 and two depths
constexpr double kOrthonormalTolerance = 1e-3;

std::filesystem::path poses_file(const std::filesystem::path& folder) {
    return folder / "poses_bounds.npy";
}

// The files cam*.mp4 in the order of their names, which is that of the rows.
std::vector<std::filesystem::path> find_videos(const std::filesystem::path& folder) {
    std::set<std::string> names;
    std::error_code failed;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("cam") && entry.path().extension() == ".mp4") names.insert(name);
    }
    std::vector<std::filesystem::path> videos;
    for (const std::string& name : names) videos.push_back(folder / name);
    return videos;
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

struct Video {
    media::ImageSize size;
    uint32_t frames;
    double fps;
};

Video describe(const std::filesystem::path& path) {
    const media::VideoReader reader(path);
    return {reader.size(), reader.frames(), reader.fps()};
}

void add_shots(Rig& rig, uint32_t camera, const std::filesystem::path& video, uint32_t frames) {
    for (uint32_t i = 0; i < frames; ++i) {
        Shot shot;
        shot.camera = camera;
        shot.time = frames > 1 ? i / (frames - 1.0) : 0;
        shot.name = fmt::format("{}_f{:04}", rig.cameras[camera].name, i);
        shot.place = fmt::format("{}, frame {}", video.filename().string(), i);
        shot.image = {video, i};
        rig.shots.push_back(shot);
    }
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
    if (videos.size() < 2)
        throw InputError(rig.file, "", "has one camera, and the first is held out for the test", "give two or more");
    std::vector<Video> described;
    for (const auto& video : videos) described.push_back(describe(video));
    const uint32_t frames = std::min_element(described.begin(), described.end(), [](const Video& a, const Video& b) {
                                return a.frames < b.frames;
                            })->frames;
    rig.fps = described[0].fps;
    for (size_t i = 0; i < videos.size(); ++i) {
        if ((i == 0) != (split == Split::kTest)) continue;
        const std::string place = fmt::format("row {}", i);
        rig.cameras.push_back(make_camera(&poses.values[i * kRow], videos[i], rig.file, place));
        fit_to_images(rig.cameras.back(), described[i].size, videos[i].string(), rig.file, place);
        add_shots(rig, static_cast<uint32_t>(rig.cameras.size() - 1), videos[i], frames);
    }
    return rig;
}

}  // namespace neuvv::training
