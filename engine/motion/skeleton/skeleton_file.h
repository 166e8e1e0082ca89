// Skeleton clips as files. README.md describes the format that is written.
#pragma once

#include <filesystem>

#include "motion/skeleton/skeleton_space.h"

namespace neuvv::motion {

constexpr const char* kSkeletonExtension = "NEUVV_skeleton";

// Writes a .glb: a node for each joint with its animation, a skin of them, and a mesh of bones that shows the motion in
// any program. The file is replaced atomically. Throws InputError for more frames than
// kMaxSkeletonFrames, and RuntimeFailure; the clip must have a frame (assert).
void write_skeleton(const std::filesystem::path& file, const SkeletonClip& clip);

// Writes a BVH of bones that begin at the joints, with +Y up; `units_per_metre`: 100 for centimetres. Each bone has its
// position in each frame, as bones of captured bodies vary in length. A joint that a frame does not know is where it
// was before. Confidence is lost. The file is replaced atomically. Throws RuntimeFailure; the clip must have a frame
// (assert).
void write_bvh(const std::filesystem::path& file, const SkeletonClip& clip, double units_per_metre);

struct SkeletonReading {
    std::string animation;   // the name or index of a glTF animation; empty: the first
    std::optional<Axis> up;  // nothing: as the format says, or as the body stands
    double unit_m = 0;       // 0: as the file says, or by the body's height
    double height_m = 0;     // of the body, whatever the unit; 0: as the unit says
};

// Reads a file of write_skeleton; or an animated humanoid of another glTF or VRM file, a BVH or a TRC file, by the
// ending of its name. Files of other programs have no confidence: what they give counts as certain. Throws InputError
// with file, place and fix.
SkeletonClip read_skeleton(const std::filesystem::path& file, const SkeletonReading& reading = {});

// A motion in its file's own units and axes.
struct FileMotion {
    SkeletonClip clip;
    double unit_m = 0;     // 0: the file does not say
    bool y_is_up = false;  // the format says so
};
// What read_skeleton reads from each kind of file.
FileMotion read_bvh(const std::filesystem::path& file);
FileMotion read_trc(const std::filesystem::path& file);

// Where the skeleton of a volumetric video is looked for: "performer.nvv" → "performer.skeleton.glb".
std::filesystem::path skeleton_beside(const std::filesystem::path& video);

}  // namespace neuvv::motion
