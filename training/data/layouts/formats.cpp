#include "training/data/layouts/formats.h"

#include <fmt/format.h>

#include <map>

#include "base/error.h"
#include "training/data/layouts/loaders.h"
#include "training/data/layouts/nerf_splits.h"
#include "training/data/layouts/rig/holdout.h"
#include "training/data/layouts/rig/plates.h"
#include "training/data/layouts/rig/presentation.h"
#include "training/data/layouts/rig/world_of_rig.h"

namespace neuvv::training {

namespace {

struct Format {
    const char* name;
    const char* files;  // the files by which it is recognised, for errors
    bool (*detects)(const std::filesystem::path& folder);
    Rig (*read)(const std::filesystem::path& folder, Split split);
    bool (*validates)(const std::filesystem::path& folder);  // whether it has Split::kVal; null: it never has
    // Whether the calibration lies in the session above; null: it never does.
    bool (*detects_session)(const std::filesystem::path& folder) = nullptr;
};

// In the order in which layouts are tried, as a folder often contains files of several programs.
constexpr Format kFormats[] = {
    {"nerf", "transforms_train.json or transforms.json", has_nerf_files, read_nerf_rig, has_nerf_validation},
    {"polycam", "keyframes/cameras/*.json", has_polycam_files, read_polycam_rig, nullptr},
    {"n3v", "poses_bounds.npy", has_n3v_files, read_n3v_rig, nullptr},
    {"easymocap", "intri.yml", has_easymocap_files, read_easymocap_rig, nullptr},
    {"colmap", "sparse/0/cameras.bin or .txt", has_colmap_files, read_colmap_rig, nullptr},
    {"record3d", "metadata and rgb/", has_record3d_files, read_record3d_rig, nullptr},
    {"panoptic", "calibration_*.json", has_panoptic_files, read_panoptic_rig, nullptr},
    {"dynamic3dgs", "train_meta.json", has_dynamic3dgs_files, read_dynamic3dgs_rig, nullptr},
    {"actorshq", "calibration.csv", has_actorshq_files, read_actorshq_rig, nullptr},
    {"metashape", "cameras.xml", has_metashape_files, read_metashape_rig, nullptr},
    {"realitycapture", "a .csv of cameras", has_realitycapture_files, read_realitycapture_rig, nullptr},
    {"qualisys", "NAME.qca.txt", has_qualisys_files, read_qualisys_rig, nullptr, has_qualisys_session},
    {"pose2sim", "Calib.toml", has_pose2sim_files, read_pose2sim_rig, nullptr, has_pose2sim_session},
    {"opencv", "<camera>.yml", has_opencv_files, read_opencv_rig, nullptr},
};

const Format& find_format(const std::filesystem::path& folder, const std::string& name) {
    std::error_code ignored;
    if (!std::filesystem::exists(folder, ignored))
        throw InputError(folder.string(), "", "there is no such folder", "check the path");
    if (!std::filesystem::is_directory(folder, ignored))
        throw InputError(folder.string(), "", "is a file, not the folder of a data set", "name its folder");
    std::string known;
    for (const Format& format : kFormats) {
        if (name == kAnyFormat ? format.detects(folder) : name == format.name) return format;
        known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", format.files, format.name);
    }
    for (const Format& format : kFormats)
        if (name == kAnyFormat && format.detects_session && format.detects_session(folder)) return format;
    if (name == kAnyFormat)
        throw InputError(folder.string(), "", "is no data set of a known layout", "name a folder that holds " + known);
    throw InputError(Setting{"format"}, name, "is not a known layout", "give one of " + known);
}

// Says which other layouts' files lie in the folder, where none was named.
void note_other_formats(Rig& rig, const Format& chosen) {
    std::string others;
    for (const Format& format : kFormats)
        if (&format != &chosen && format.detects(rig.folder))
            others += fmt::format("{}{} ({})", others.empty() ? "" : ", ", format.name, format.files);
    if (!others.empty())
        rig.remarks.push_back(
            fmt::format("read as {}; the folder also has files of {}, which are read where that format is named",
                        chosen.name, others));
}

// Checks what must hold in every layout. Errors name the place in the layout's own file.
void expect_sound(const Rig& rig) {
    if (rig.shots.empty())
        throw InputError(rig.file.empty() ? rig.folder.string() : rig.file, "", "has no image of this split");
    std::map<std::pair<std::filesystem::path, int64_t>, const Shot*> images;
    std::map<std::pair<uint32_t, double>, const Shot*> shots_by_time;
    std::map<std::string, const Shot*> names;
    for (const Shot& shot : rig.shots) {
        const auto fail = [&](const std::string& problem, const std::string& fix) {
            throw InputError(rig.file, shot.place, problem, fix);
        };
        if (!(shot.time >= 0 && shot.time <= 1)) fail(fmt::format("has the time {}, outside [0,1]", shot.time), "");
        const auto image = std::pair(shot.image.path.lexically_normal(), shot.image.video_frame);
        if (const auto [same, fresh] = images.try_emplace(image, &shot); !fresh)
            fail("is the image of " + same->second->place + " again", "give each frame its own image");
        if (const auto [same, alone] = shots_by_time.try_emplace({shot.camera, shot.time}, &shot); !alone)
            fail("has the camera and the time of " + same->second->place,
                 "remove the duplicate, or give each frame its time");
        if (const auto [same, alone] = names.try_emplace(shot.name, &shot); !alone)
            fail(fmt::format("bears the name {} of {}", shot.name, same->second->place), "rename its image");
    }
}

}  // namespace

std::vector<std::string> format_names() {
    std::vector<std::string> names = {kAnyFormat};
    for (const Format& format : kFormats) names.push_back(format.name);
    return names;
}

void drop_cameras_without_shots(Rig& rig) {
    std::vector<RigCamera> kept;
    std::map<uint32_t, uint32_t> numbers;
    for (Shot& shot : rig.shots) {
        const auto [number, fresh] = numbers.try_emplace(shot.camera, static_cast<uint32_t>(kept.size()));
        if (fresh) kept.push_back(rig.cameras.at(shot.camera));
        shot.camera = number->second;
    }
    rig.cameras = std::move(kept);
}

namespace {

Rig read_any_rig(const std::filesystem::path& folder, Split split, const std::string& format,
                 const std::string& holdout) {
    const Format& layout = find_format(folder, format);
    if (split == Split::kVal && (!layout.validates || !holdout.empty()))
        throw InputError(folder.string(), "", fmt::format("{} data sets have no validation split", layout.name),
                         "take train or test");
    Rig rig = layout.read(folder, holdout.empty() ? split : Split::kAll);
    if (!holdout.empty()) select_split(rig, holdout, split);
    if (format == kAnyFormat) note_other_formats(rig, layout);
    place_near_origin(rig);
    drop_cameras_without_shots(rig);  // some layouts calibrate the cameras of all splits
    find_plates(rig);
    expect_sound(rig);
    settle_presentation(rig);
    return rig;
}

}  // namespace

Rig read_rig(const std::filesystem::path& folder, Split split, const std::string& format, const std::string& holdout) {
    Rig rig = read_any_rig(folder, split, format, holdout);
    if (rig.misfit) throw *rig.misfit;
    return rig;
}

Rig read_rig_of_points(const std::filesystem::path& folder) {
    return read_any_rig(folder, Split::kAll, kAnyFormat, "");
}

bool has_validation(const std::filesystem::path& folder, const std::string& format) {
    const Format& layout = find_format(folder, format);
    return layout.validates && layout.validates(folder);
}

}  // namespace neuvv::training
