// What programs call the bones and markers of a body, and which of a file's are the ones that a skeleton needs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace neuvv::motion {

enum class Side : uint8_t { kNone, kRight, kLeft };

enum BoneKind : uint8_t {
    kHeadBone,
    kNeckBone,
    kPelvisBone,
    kNoseBone,
    kUpperArm,
    kForearm,
    kHand,
    kShin,
    kThigh,
    kFoot,
    kToes,
    kHeel,
    kBigToe,
    kSmallToe,
    kBoneKinds
};

// Which of a file's bones, or markers, are these; a bone is of one kind at most.
struct FoundBones {
    // By BoneKind: of the middle or the right, and of the left.
    std::array<std::array<std::optional<size_t>, 2>, kBoneKinds> bones;

    size_t of(BoneKind kind, Side side = Side::kNone) const { return *bones[kind][side == Side::kLeft]; }
    bool has(BoneKind kind, Side side = Side::kNone) const { return bones[kind][side == Side::kLeft].has_value(); }
    std::string missing() const;  // of the bones that a body needs: "head, left foot"
};

// Recognises the names of VRM and VRoid, Mixamo, SMPL, Kinect, the CMU and other BVH files, Xsens, Vicon, OptiTrack,
// Rokoko, Unreal, 3ds Max, DAZ, Rigify and OpenPose: sides before or behind the name, prefixes that most names share.
// Where a skeleton has both, ankle and wrist win over foot and hand, which are then the ball of the foot and the palm.
// Empty names are no bones.
FoundBones find_bones(std::span<const std::string> names);

}  // namespace neuvv::motion
