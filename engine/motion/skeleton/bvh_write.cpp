// Writing Biovision's BVH.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "base/output_path.h"
#include "motion/skeleton/bone_motion.h"
#include "motion/skeleton/skeleton_file.h"

namespace neuvv::motion {

namespace {

// As most programs call the bones that begin at the joints, in the order of Joint, which is that of a BVH's text, too.
constexpr std::array<const char*, kJoints> kBvhNames = {
    "Hips",          "Neck",      "Nose",       "RightArm", "RightForeArm", "RightHand",  "LeftArm",
    "LeftForeArm",   "LeftHand",  "RightUpLeg", "RightLeg", "RightFoot",    "RightHeel",  "RightBigToe",
    "RightSmallToe", "LeftUpLeg", "LeftLeg",    "LeftFoot", "LeftHeel",     "LeftBigToe", "LeftSmallToe"};
// The head's bone begins between neck and nose.
constexpr double kHeadAt = 0.5;
// The bones at the ends of limbs are as long as this part of those before them.
constexpr double kEndLength = 0.25;
constexpr const char* kBvhChannels = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";

struct WrittenBone {
    std::string name;
    size_t parent = 0;  // index of a bone before it
    glm::dvec3 offset{0};
    std::vector<BoneTransform> frames;
};

// The bones of all joints, and one for the head before the nose.
std::vector<WrittenBone> written_bones(const SkeletonClip& clip) {
    const std::vector<Positions> positions = filled_positions(clip);
    std::vector<std::array<BoneTransform, kJoints>> frames;
    for (const Positions& now : positions) frames.push_back(bone_transforms(positions[0], now));
    std::vector<WrittenBone> bones;
    std::array<size_t, kJoints> bone_of{};
    for (size_t j = 0; j < kJoints; ++j) {
        const auto joint = joint_at(j);
        const size_t above = index_of(info_of(joint).parent), parent = bone_of[above];
        const Positions& rest = positions[0];
        WrittenBone bone{kBvhNames[j], parent, j == 0 ? rest[0] : rest[j] - rest[above], {}};
        for (const auto& frame : frames) bone.frames.push_back(frame[j]);
        if (joint == Joint::kNose) {
            WrittenBone head{"Head", parent, kHeadAt * bone.offset, {}};
            for (BoneTransform& frame : bone.frames) {
                const glm::dquat turn = swing(bone.offset, frame.translation);
                head.frames.push_back({kHeadAt * frame.translation, turn});
                frame = {(1 - kHeadAt) * (glm::conjugate(turn) * frame.translation), glm::dquat(1, 0, 0, 0)};
            }
            bone.offset *= 1 - kHeadAt;
            bone.parent = bones.size();
            bones.push_back(std::move(head));
        }
        bone_of[j] = bones.size();
        bones.push_back(std::move(bone));
    }
    return bones;
}

// Degrees about z, x and y, applied in this order: R = Rz Rx Ry.
glm::dvec3 angles_of(const glm::dquat& rotation) {
    const glm::dmat3 r = glm::mat3_cast(rotation);  // r[column][row]
    const double x = std::asin(std::clamp(r[1][2], -1.0, 1.0));
    if (std::hypot(r[0][2], r[2][2]) < 1e-9)  // z and y turn about the same axis
        return glm::degrees(glm::dvec3(std::atan2(r[0][1], r[0][0]), x, 0));
    return glm::degrees(glm::dvec3(std::atan2(-r[1][0], r[1][1]), x, std::atan2(-r[0][2], r[2][2])));
}

// The same rotation by the angles that are nearest to those before it, so that programs may mix frames.
glm::dvec3 near_to(const glm::dvec3& before, const glm::dvec3& angles) {
    const auto wound = [&](const glm::dvec3& a) { return a + 360.0 * glm::round((before - a) / 360.0); };
    const glm::dvec3 one = wound(angles), other = wound({angles[0] + 180, 180 - angles[1], angles[2] + 180});
    return glm::distance(one, before) <= glm::distance(other, before) ? one : other;
}

void append_offset(const glm::dvec3& offset, double units, const std::string& indent, std::string& text) {
    fmt::format_to(std::back_inserter(text), "{}OFFSET {:.7f} {:.7f} {:.7f}\n", indent, units * offset.x,
                   units * offset.y, units * offset.z);
}

// A bone with those below it, of which `next` is the first, and is behind the last at the end.
void append_bone(const std::vector<WrittenBone>& bones, size_t& next, double units, size_t level, std::string& text) {
    const size_t index = next++;
    const std::string outer(2 * level, ' '), inner(2 * level + 2, ' ');
    text += fmt::format("{}{} {}\n{}{{\n", outer, level == 0 ? "ROOT" : "JOINT", bones[index].name, outer);
    append_offset(bones[index].offset, units, inner, text);
    text += inner + kBvhChannels + "\n";
    if (next == bones.size() || bones[next].parent != index) {
        text += fmt::format("{}End Site\n{}{{\n", inner, inner);
        append_offset(kEndLength * bones[index].offset, units, inner + "  ", text);
        text += inner + "}\n";
    }
    while (next < bones.size() && bones[next].parent == index) append_bone(bones, next, units, level + 1, text);
    text += outer + "}\n";
}

}  // namespace

void write_bvh(const std::filesystem::path& file, const SkeletonClip& clip, double units_per_metre) {
    assert(!clip.frames.empty());
    const std::vector<WrittenBone> bones = written_bones(clip);
    std::string text = "HIERARCHY\n";
    size_t next = 0;
    append_bone(bones, next, units_per_metre, 0, text);
    text += fmt::format("MOTION\nFrames: {}\nFrame Time: {:.9f}\n", clip.frames.size(), 1 / clip.fps);
    std::vector<glm::dvec3> angles(bones.size(), glm::dvec3(0));
    for (size_t f = 0; f < clip.frames.size(); ++f) {
        for (size_t b = 0; b < bones.size(); ++b) {
            const BoneTransform& bone = bones[b].frames[f];
            const glm::dvec3 at = units_per_metre * bone.translation;
            angles[b] = near_to(angles[b], angles_of(bone.rotation));
            fmt::format_to(std::back_inserter(text), "{}{:.7f} {:.7f} {:.7f} {:.6f} {:.6f} {:.6f}", b > 0 ? " " : "",
                           at.x, at.y, at.z, angles[b][0], angles[b][1], angles[b][2]);
        }
        text += '\n';
    }
    write_text_file(file, text);
}

}  // namespace neuvv::motion
