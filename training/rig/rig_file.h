// What a clip in segments corrects of its rig, as rig.json in the clip's folder. It is found once, from the images of
// one segment, so that all segments see through the same cameras, whichever process trains them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"
#include "training/rig/rig_changes.h"
#include "training/step/camera_colour.h"

namespace neuvv::training {

struct RigCorrection {
    ColourRefinement colour;           // what each segment learns beside
    std::vector<std::string> cameras;  // RigCamera::name
    RigChanges changes;                // of these cameras
};

std::filesystem::path rig_file(const std::filesystem::path& clip);

// Writes rig.json into an existing folder, atomically. Throws RuntimeFailure.
void write_rig_correction(const std::filesystem::path& clip, const RigCorrection& correction);

// Nothing where the clip has no rig.json. Throws InputError with file, place and fix for what is damaged, and for
// numbers that no search finds.
std::optional<RigCorrection> read_rig_correction(const std::filesystem::path& clip);

// Moves the shots of cameras that are late by whole frames to the frames that they show, and drops those beyond the
// clip: before the clip is cut, so that a segment gets the images that were taken in its neighbours.
void move_late_shots(const RigCorrection& correction, Rig& rig);

// The changes for some of the cameras, in their order, which are left after move_late_shots. Cameras that the
// correction does not know stay as they are.
RigChanges changes_of(const RigCorrection& correction, const std::vector<RigCamera>& cameras);

}  // namespace neuvv::training
