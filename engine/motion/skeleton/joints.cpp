#include "motion/skeleton/joints.h"

#include <fmt/format.h>

namespace neuvv::motion {

namespace {

constexpr std::array<JointInfo, kJoints> kInfos = [] {
    using enum Joint;
    using enum Limb;
    return std::array<JointInfo, kJoints>{{
        {"pelvis", kPelvis, kPelvis, kTrunk},
        {"neck", kPelvis, kNeck, kTrunk},
        {"nose", kNeck, kNose, kHead},
        {"right_shoulder", kNeck, kLeftShoulder, kTrunk},
        {"right_elbow", kRightShoulder, kLeftElbow, kRightArm},
        {"right_wrist", kRightElbow, kLeftWrist, kRightArm},
        {"left_shoulder", kNeck, kRightShoulder, kTrunk},
        {"left_elbow", kLeftShoulder, kRightElbow, kLeftArm},
        {"left_wrist", kLeftElbow, kRightWrist, kLeftArm},
        {"right_hip", kPelvis, kLeftHip, kTrunk},
        {"right_knee", kRightHip, kLeftKnee, kRightLeg},
        {"right_ankle", kRightKnee, kLeftAnkle, kRightLeg},
        {"right_heel", kRightAnkle, kLeftHeel, kRightLeg},
        {"right_big_toe", kRightAnkle, kLeftBigToe, kRightLeg},
        {"right_small_toe", kRightAnkle, kLeftSmallToe, kRightLeg},
        {"left_hip", kPelvis, kRightHip, kTrunk},
        {"left_knee", kLeftHip, kRightKnee, kLeftLeg},
        {"left_ankle", kLeftKnee, kRightAnkle, kLeftLeg},
        {"left_heel", kLeftAnkle, kRightHeel, kLeftLeg},
        {"left_big_toe", kLeftAnkle, kRightBigToe, kLeftLeg},
        {"left_small_toe", kLeftAnkle, kRightSmallToe, kLeftLeg},
    }};
}();

constexpr std::array<int, 2> kLacking = {-1, -1};
constexpr std::array<int, 2> from(int point) {
    return {point, point};
}

// Sources in the order of Joint: pelvis, neck, nose; right and left arm; right and left leg. The larger sets of HALPE,
// and BODY_135, begin with the points of the smaller.
using Sources = std::array<std::array<int, 2>, kJoints>;
constexpr Sources kHalpe = {{from(19), from(18), from(0),  from(6),  from(8),  from(10), from(5),
                             from(7),  from(9),  from(12), from(14), from(16), from(25), from(21),
                             from(23), from(11), from(13), from(15), from(24), from(20), from(22)}};
constexpr Sources kBody25b = {{{11, 12}, {5, 6},   from(0),  from(6),  from(8),  from(10), from(5),
                               from(7),  from(9),  from(12), from(14), from(16), from(24), from(22),
                               from(23), from(11), from(13), from(15), from(21), from(19), from(20)}};
constexpr KeyPointLayout kLayouts[] = {
    {"COCO-17", "BODY", 17, {{{11, 12}, {5, 6},   from(0),  from(6),  from(8),  from(10), from(5),
                              from(7),  from(9),  from(12), from(14), from(16), kLacking, kLacking,
                              kLacking, from(11), from(13), from(15), kLacking, kLacking, kLacking}}},
    {"BODY_25", "", 25, {{from(8),  from(1),  from(0),  from(2),  from(3),  from(4),  from(5),
                          from(6),  from(7),  from(9),  from(10), from(11), from(24), from(22),
                          from(23), from(12), from(13), from(14), from(21), from(19), from(20)}}},
    {"HALPE-26", "BODY_WITH_FEET", 26, kHalpe},
    {"MediaPipe-33", "BLAZEPOSE", 33, {{{23, 24}, {11, 12}, from(0),  from(12), from(14), from(16), from(11),
                                        from(13), from(15), from(24), from(26), from(28), from(30), from(32),
                                        kLacking, from(23), from(25), from(27), from(29), from(31), kLacking}}},
    {"OpenPose-18", "COCO", 18, {{{8, 11},  from(1),  from(0),  from(2),  from(3),  from(4),  from(5),
                                  from(6),  from(7),  from(8),  from(9),  from(10), kLacking, kLacking,
                                  kLacking, from(11), from(12), from(13), kLacking, kLacking, kLacking}}},
    {"COCO-133", "COCO-WholeBody", 133, {{{11, 12}, {5, 6},   from(0),  from(6),  from(8),  from(10), from(5),
                                          from(7),  from(9),  from(12), from(14), from(16), from(22), from(20),
                                          from(21), from(11), from(13), from(15), from(19), from(17), from(18)}}},
    {"HALPE-136", "", 136, kHalpe},
    {"HALPE-68", "", 68, kHalpe},
    {"BODY_25B", "", 25, kBody25b},
    {"BODY_135", "", 135, kBody25b},
};

std::string plain(std::string_view name) {
    std::string result;
    for (const char c : name)
        if (c != '-' && c != '_') result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return result;
}

}  // namespace

const JointInfo& info_of(Joint joint) {
    return kInfos[index_of(joint)];
}

const KeyPointLayout* find_key_point_layout(size_t points) {
    for (const KeyPointLayout& layout : kLayouts)
        if (layout.points == points) return &layout;
    return nullptr;
}

const KeyPointLayout* find_key_point_layout(std::string_view name) {
    for (const KeyPointLayout& layout : kLayouts)
        if (plain(layout.name) == plain(name) || (!name.empty() && plain(layout.other_name) == plain(name)))
            return &layout;
    return nullptr;
}

std::string key_point_layouts() {
    std::string text;
    for (const KeyPointLayout& layout : kLayouts) text += fmt::format("{}{}", text.empty() ? "" : ", ", layout.name);
    return text;
}

}  // namespace neuvv::motion
