// The joints of a skeleton, and the key points of 2D detectors that they are read from.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace neuvv::motion {

// Parents stand before their children. "Left" is the performer's own left. The set is that of OpenPose's BODY_25
// without eyes and ears: what a detector sees of a body, feet included.
enum class Joint : uint8_t {
    kPelvis,  // the centre of both hips
    kNeck,    // the centre of both shoulders
    kNose,
    kRightShoulder,
    kRightElbow,
    kRightWrist,
    kLeftShoulder,
    kLeftElbow,
    kLeftWrist,
    kRightHip,
    kRightKnee,
    kRightAnkle,
    kRightHeel,
    kRightBigToe,
    kRightSmallToe,
    kLeftHip,
    kLeftKnee,
    kLeftAnkle,
    kLeftHeel,
    kLeftBigToe,
    kLeftSmallToe,
};
constexpr size_t kJoints = 21;

// The parts of a body that are compared, coloured and named in reports, and that a detector swaps as a whole.
enum class Limb : uint8_t { kTrunk, kHead, kRightArm, kLeftArm, kRightLeg, kLeftLeg };
constexpr size_t kLimbs = 6;
constexpr std::array<const char*, kLimbs> kLimbNames = {"trunk",    "head",      "right arm",
                                                        "left arm", "right leg", "left leg"};

struct JointInfo {
    const char* name;  // in files: "left_wrist"
    Joint parent;      // the pelvis is its own
    Joint mirrored;    // the same joint of the other side, or itself
    Limb limb;         // to which the bone from the parent belongs
};
const JointInfo& info_of(Joint joint);

constexpr size_t index_of(Joint joint) {
    return static_cast<size_t>(joint);
}
constexpr size_t index_of(Limb limb) {
    return static_cast<size_t>(limb);
}
constexpr Joint joint_at(size_t index) {
    return static_cast<Joint>(index);
}

// The key points of a detector, by their numbers in its files.
struct KeyPointLayout {
    const char* name;
    const char* other_name;  // in other programs
    size_t points;
    // The key points whose mean is the joint; {n, n}: the key point itself; {−1, −1}: the layout lacks the joint.
    std::array<std::array<int, 2>, kJoints> sources;
};

// The first layout with so many points, which is BODY_25 for 25; null where there is none.
const KeyPointLayout* find_key_point_layout(size_t points);
// The layout of this name, whatever its letters and dashes: "COCO-17", "coco_17"; null where there is none.
const KeyPointLayout* find_key_point_layout(std::string_view name);
// The names of all layouts, for messages: "COCO-17, BODY_25, ...".
std::string key_point_layouts();

}  // namespace neuvv::motion
