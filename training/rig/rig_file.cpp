#include "training/rig/rig_file.h"

#include <algorithm>
#include <cmath>

#include "base/formats/json.h"
#include "base/output_path.h"
#include "training/data/segments.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kVersion = 1;
constexpr size_t kMostCameras = 100'000;
constexpr std::array<const char*, kPoseNumbers> kNames = {"turn_x",  "turn_y",  "turn_z",   "shift_x",
                                                          "shift_y", "shift_z", "log_focal"};

PoseChange pose_from(const JsonNode& camera) {
    PoseChange pose;
    for (size_t i = 0; i < kPoseNumbers; ++i) pose[i] = json_number(camera[kNames[i]]);
    if (!is_possible(pose)) camera.fail("is a pose that is farther from the calibration than any run finds");
    return pose;
}

// Where the correction has the camera; nothing where it does not know it.
std::optional<size_t> index_of(const RigCorrection& correction, const RigCamera& camera) {
    const auto found = std::ranges::find(correction.cameras, camera.name);
    if (found == correction.cameras.end()) return std::nullopt;
    return static_cast<size_t>(found - correction.cameras.begin());
}

}  // namespace

std::filesystem::path rig_file(const std::filesystem::path& clip) {
    return clip / "rig.json";
}

void write_rig_correction(const std::filesystem::path& clip, const RigCorrection& correction) {
    nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
    const RigChanges& changes = correction.changes;
    for (size_t i = 0; i < correction.cameras.size(); ++i) {
        nlohmann::ordered_json camera{{"name", correction.cameras[i]}};
        if (!changes.poses.empty())
            for (size_t number = 0; number < kPoseNumbers; ++number) camera[kNames[number]] = changes.poses[i][number];
        if (!changes.frames_late.empty()) camera["frames_late"] = changes.frames_late[i];
        if (!changes.readout.empty()) camera["readout"] = changes.readout[i];
        cameras.push_back(std::move(camera));
    }
    write_text_file(rig_file(clip), json_text({{"neuvv_rig", kVersion},
                                               {"colour", correction.colour.colour},
                                               {"exposure", correction.colour.exposure},
                                               {"vignetting", correction.colour.vignetting},
                                               {"poses", !changes.poses.empty()},
                                               {"time", !changes.frames_late.empty()},
                                               {"cameras", cameras}}));
}

std::optional<RigCorrection> read_rig_correction(const std::filesystem::path& clip) {
    if (!std::filesystem::exists(rig_file(clip))) return std::nullopt;
    const JsonFile file = read_json(rig_file(clip), "the corrections of a clip's rig");
    const JsonNode root = file.root();
    if (json_count(root["neuvv_rig"], UINT32_MAX) > kVersion)
        root["neuvv_rig"].fail("is a version that this program does not know", "train with a newer neuvv");
    RigCorrection correction;
    correction.colour = {json_flag(root["colour"]), json_flag(root["exposure"]), json_flag(root["vignetting"])};
    const bool poses = json_flag(root["poses"]), time = json_flag(root["time"]);
    const JsonNode cameras = root["cameras"];
    expect_list(cameras);
    if (cameras.value.size() > kMostCameras) cameras.fail("has more cameras than any rig");
    for (size_t i = 0; i < cameras.value.size(); ++i) {
        const JsonNode camera = cameras[i];
        correction.cameras.push_back(json_string(camera["name"]));
        if (poses) correction.changes.poses.push_back(pose_from(camera));
        if (!time) continue;
        correction.changes.frames_late.push_back(
            json_number(camera["frames_late"], -kMostFramesLate, kMostFramesLate, "a number of frames"));
        correction.changes.readout.push_back(camera.has("readout") ? json_number(camera["readout"], -kLongestReadout,
                                                                                 kLongestReadout, "a number of frames")
                                                                   : 0);
    }
    return correction;
}

void move_late_shots(const RigCorrection& correction, Rig& rig) {
    const std::vector<double>& late = correction.changes.frames_late;
    if (late.empty()) return;
    const std::vector<double> times = times_of(rig);
    std::erase_if(rig.shots, [&](Shot& shot) {
        const std::optional<size_t> camera = index_of(correction, rig.cameras[shot.camera]);
        const auto frame = std::ranges::lower_bound(times, shot.time) - times.begin();
        const auto shown = frame + (camera ? std::lround(late[*camera]) : 0);
        if (shown < 0 || shown >= std::ssize(times)) return true;
        shot.time = times[static_cast<size_t>(shown)];
        return false;
    });
}

RigChanges changes_of(const RigCorrection& correction, const std::vector<RigCamera>& cameras) {
    const std::vector<double>& late = correction.changes.frames_late;
    RigChanges changes;
    for (const RigCamera& camera : cameras) {
        const std::optional<size_t> index = index_of(correction, camera);
        if (!correction.changes.poses.empty())
            changes.poses.push_back(index ? correction.changes.poses[*index] : PoseChange{});
        if (!late.empty()) changes.frames_late.push_back(index ? late[*index] - std::round(late[*index]) : 0);
        if (!correction.changes.readout.empty())
            changes.readout.push_back(index ? correction.changes.readout[*index] : 0);
    }
    return changes;
}

}  // namespace neuvv::training
