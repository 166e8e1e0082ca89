// The names that programs give to the bones of a body.
#include "motion/skeleton/bone_names.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <vector>

namespace neuvv {
namespace {

using motion::Side;

struct Naming {
    const char* program;
    // Pairs of a bone's kind and its name; % is the side. Bones of kBoneKinds must not be taken.
    std::vector<std::pair<motion::BoneKind, std::string>> bones;
    const char *right, *left;
};

std::string with_side(std::string name, const char* side) {
    if (const size_t at = name.find('%'); at != std::string::npos) name.replace(at, 1, side);
    return name;
}

const motion::BoneKind kOther = motion::kBoneKinds;

using motion::kBigToe;
using motion::kFoot;
using motion::kForearm;
using motion::kHand;
using motion::kHeadBone;
using motion::kHeel;
using motion::kNeckBone;
using motion::kNoseBone;
using motion::kPelvisBone;
using motion::kShin;
using motion::kSmallToe;
using motion::kThigh;
using motion::kToes;
using motion::kUpperArm;

const std::vector<Naming> kNamings = {
    {"SMPL",
     {{kOther, "m_avg_root"},
      {kPelvisBone, "m_avg_Pelvis"},
      {kOther, "m_avg_Spine1"},
      {kNeckBone, "m_avg_Neck"},
      {kHeadBone, "m_avg_Head"},
      {kOther, "m_avg_%_Collar"},
      {kUpperArm, "m_avg_%_Shoulder"},
      {kForearm, "m_avg_%_Elbow"},
      {kOther, "m_avg_%_Palm"},
      {kHand, "m_avg_%_Wrist"},
      {kOther, "m_avg_%_Hand"},
      {kThigh, "m_avg_%_Hip"},
      {kShin, "m_avg_%_Knee"},
      {kFoot, "m_avg_%_Ankle"},
      {kToes, "m_avg_%_Foot"}},
     "R",
     "L"},
    {"SMPL-X",
     {{kPelvisBone, "pelvis"},
      {kHeadBone, "head"},
      {kOther, "%_collar"},
      {kUpperArm, "%_shoulder"},
      {kForearm, "%_elbow"},
      {kHand, "%_wrist"},
      {kOther, "%_index1"},
      {kThigh, "%_hip"},
      {kShin, "%_knee"},
      {kFoot, "%_ankle"},
      {kToes, "%_foot"}},
     "right",
     "left"},
    {"Azure Kinect",
     {{kPelvisBone, "PELVIS"},
      {kOther, "SPINE_CHEST"},
      {kHeadBone, "HEAD"},
      {kNoseBone, "NOSE"},
      {kOther, "CLAVICLE_%"},
      {kUpperArm, "SHOULDER_%"},
      {kForearm, "ELBOW_%"},
      {kOther, "HAND_%"},
      {kHand, "WRIST_%"},
      {kOther, "HANDTIP_%"},
      {kThigh, "HIP_%"},
      {kShin, "KNEE_%"},
      {kToes, "FOOT_%"},
      {kFoot, "ANKLE_%"}},
     "RIGHT",
     "LEFT"},
    {"Kinect 1",
     {{kPelvisBone, "HipCenter"},
      {kNeckBone, "ShoulderCenter"},
      {kHeadBone, "Head"},
      {kUpperArm, "Shoulder%"},
      {kForearm, "Elbow%"},
      {kHand, "Wrist%"},
      {kOther, "Hand%"},
      {kThigh, "Hip%"},
      {kShin, "Knee%"},
      {kFoot, "Ankle%"},
      {kToes, "Foot%"}},
     "Right",
     "Left"},
    {"Xsens",
     {{kPelvisBone, "Pelvis"},
      {kOther, "L5"},
      {kOther, "T8"},
      {kHeadBone, "Head"},
      {kOther, "%Shoulder"},
      {kUpperArm, "%UpperArm"},
      {kForearm, "%ForeArm"},
      {kHand, "%Hand"},
      {kThigh, "%UpperLeg"},
      {kShin, "%LowerLeg"},
      {kFoot, "%Foot"},
      {kToes, "%Toe"}},
     "Right",
     "Left"},
    {"Xsens, BVH",
     {{kPelvisBone, "Hips"},
      {kOther, "Chest4"},
      {kHeadBone, "Head"},
      {kOther, "%Collar"},
      {kUpperArm, "%Shoulder"},
      {kForearm, "%Elbow"},
      {kHand, "%Wrist"},
      {kThigh, "%Hip"},
      {kShin, "%Knee"},
      {kFoot, "%Ankle"},
      {kToes, "%Toe"}},
     "Right",
     "Left"},
    {"Rokoko",
     {{kPelvisBone, "Hips"},
      {kHeadBone, "Head"},
      {kOther, "%Shoulder"},
      {kUpperArm, "%Arm"},
      {kForearm, "%ForeArm"},
      {kHand, "%Hand"},
      {kThigh, "%Thigh"},
      {kShin, "%Shin"},
      {kFoot, "%Foot"},
      {kToes, "%Toe"},
      {kOther, "%ToeTip"}},
     "Right",
     "Left"},
    {"OptiTrack",
     {{kPelvisBone, "Skeleton 001_Hip"},
      {kOther, "Skeleton 001_Ab"},
      {kHeadBone, "Skeleton 001_Head"},
      {kOther, "Skeleton 001_%Shoulder"},
      {kUpperArm, "Skeleton 001_%UArm"},
      {kForearm, "Skeleton 001_%FArm"},
      {kHand, "Skeleton 001_%Hand"},
      {kThigh, "Skeleton 001_%Thigh"},
      {kShin, "Skeleton 001_%Shin"},
      {kFoot, "Skeleton 001_%Foot"},
      {kToes, "Skeleton 001_%Toe"}},
     "R",
     "L"},
    {"Vicon and CMU, ASF",
     {{kOther, "root"},
      {kHeadBone, "head"},
      {kOther, "%hipjoint"},
      {kOther, "%clavicle"},
      {kUpperArm, "%humerus"},
      {kForearm, "%radius"},
      {kHand, "%wrist"},
      {kOther, "%hand"},
      {kThigh, "%femur"},
      {kShin, "%tibia"},
      {kFoot, "%foot"},
      {kToes, "%toes"}},
     "r",
     "l"},
    {"CMU, BVH",
     {{kPelvisBone, "Hips"},
      {kOther, "%HipJoint"},
      {kHeadBone, "Head"},
      {kUpperArm, "%Arm"},
      {kForearm, "%ForeArm"},
      {kHand, "%Hand"},
      {kThigh, "%UpLeg"},
      {kShin, "%Leg"},
      {kFoot, "%Foot"},
      {kToes, "%ToeBase"}},
     "Right",
     "Left"},
    {"3ds Max",
     {{kOther, "Bip01"},
      {kPelvisBone, "Bip01 Pelvis"},
      {kHeadBone, "Bip01 Head"},
      {kOther, "Bip01 % Clavicle"},
      {kUpperArm, "Bip01 % UpperArm"},
      {kForearm, "Bip01 % Forearm"},
      {kHand, "Bip01 % Hand"},
      {kThigh, "Bip01 % Thigh"},
      {kShin, "Bip01 % Calf"},
      {kFoot, "Bip01 % Foot"},
      {kToes, "Bip01 % Toe0"}},
     "R",
     "L"},
    {"Source",
     {{kPelvisBone, "ValveBiped.Bip01_Pelvis"},
      {kHeadBone, "ValveBiped.Bip01_Head1"},
      {kUpperArm, "ValveBiped.Bip01_%_UpperArm"},
      {kForearm, "ValveBiped.Bip01_%_Forearm"},
      {kHand, "ValveBiped.Bip01_%_Hand"},
      {kThigh, "ValveBiped.Bip01_%_Thigh"},
      {kShin, "ValveBiped.Bip01_%_Calf"},
      {kFoot, "ValveBiped.Bip01_%_Foot"}},
     "R",
     "L"},
    {"Unreal",
     {{kOther, "root"},
      {kPelvisBone, "pelvis"},
      {kOther, "ik_foot_%"},
      {kOther, "ik_hand_%"},
      {kHeadBone, "head"},
      {kUpperArm, "upperarm_%"},
      {kOther, "upperarm_twist_01_%"},
      {kForearm, "lowerarm_%"},
      {kHand, "hand_%"},
      {kThigh, "thigh_%"},
      {kShin, "calf_%"},
      {kFoot, "foot_%"},
      {kToes, "ball_%"}},
     "r",
     "l"},
    {"Character Creator",
     {{kPelvisBone, "CC_Base_Pelvis"},
      {kHeadBone, "CC_Base_Head"},
      {kUpperArm, "CC_Base_%_Upperarm"},
      {kForearm, "CC_Base_%_Forearm"},
      {kHand, "CC_Base_%_Hand"},
      {kThigh, "CC_Base_%_Thigh"},
      {kShin, "CC_Base_%_Calf"},
      {kFoot, "CC_Base_%_Foot"},
      {kToes, "CC_Base_%_ToeBase"}},
     "R",
     "L"},
    {"Rigify, whose children stand first",
     {{kOther, "DEF-upper_arm.%.001"},
      {kUpperArm, "DEF-upper_arm.%"},
      {kOther, "DEF-forearm.%.001"},
      {kForearm, "DEF-forearm.%"},
      {kHand, "DEF-hand.%"},
      {kOther, "DEF-thigh.%.001"},
      {kThigh, "DEF-thigh.%"},
      {kShin, "DEF-shin.%"},
      {kFoot, "DEF-foot.%"},
      {kToes, "DEF-toe.%"},
      {kOther, "DEF-spine.005"},
      {kHeadBone, "DEF-spine.006"},
      {kOther, "hand_ik.%"}},
     "R",
     "L"},
    {"DAZ",
     {{kHeadBone, "head"},
      {kUpperArm, "%ShldrBend"},
      {kOther, "%ShldrTwist"},
      {kForearm, "%ForearmBend"},
      {kHand, "%Hand"},
      {kThigh, "%ThighBend"},
      {kOther, "%ThighTwist"},
      {kShin, "%Shin"},
      {kFoot, "%Foot"},
      {kToes, "%Toe"}},
     "r",
     "l"},
    {"Mixamo through MotionBuilder",
     {{kPelvisBone, "Character1_Hips"},
      {kHeadBone, "Character1_Head"},
      {kOther, "Character1_%Shoulder"},
      {kUpperArm, "Character1_%Arm"},
      {kForearm, "Character1_%ForeArm"},
      {kHand, "Character1_%Hand"},
      {kOther, "Character1_%HandThumb1"},
      {kThigh, "Character1_%UpLeg"},
      {kShin, "Character1_%Leg"},
      {kFoot, "Character1_%Foot"},
      {kToes, "Character1_%ToeBase"}},
     "Right",
     "Left"},
    {"OpenPose",
     {{kNoseBone, "Nose"},
      {kNeckBone, "Neck"},
      {kPelvisBone, "MidHip"},
      {kUpperArm, "%Shoulder"},
      {kForearm, "%Elbow"},
      {kHand, "%Wrist"},
      {kThigh, "%Hip"},
      {kShin, "%Knee"},
      {kFoot, "%Ankle"},
      {kHeel, "%Heel"},
      {kBigToe, "%BigToe"},
      {kSmallToe, "%SmallToe"},
      {kOther, "%Eye"}},
     "R",
     "L"},
    {"Second Life",
     {{kPelvisBone, "mPelvis"},
      {kHeadBone, "mHead"},
      {kOther, "mCollar%"},
      {kUpperArm, "mShoulder%"},
      {kForearm, "mElbow%"},
      {kHand, "mWrist%"},
      {kThigh, "mHip%"},
      {kShin, "mKnee%"},
      {kFoot, "mAnkle%"},
      {kToes, "mFoot%"}},
     "Right",
     "Left"},
    {"ARKit",
     {{kPelvisBone, "hips_joint"},
      {kHeadBone, "head_joint"},
      {kOther, "%_shoulder_1_joint"},
      {kUpperArm, "%_arm_joint"},
      {kForearm, "%_forearm_joint"},
      {kHand, "%_hand_joint"},
      {kThigh, "%_upLeg_joint"},
      {kShin, "%_leg_joint"},
      {kFoot, "%_foot_joint"},
      {kToes, "%_toes_joint"}},
     "right",
     "left"},
};

TEST(BoneNames, OfManyProgramsAreKnown) {
    for (const Naming& naming : kNamings) {
        std::vector<std::string> names;
        for (const auto& [kind, name] : naming.bones)
            for (const char* side : {naming.right, naming.left}) {
                if (name.find('%') == std::string::npos && side == naming.left) continue;
                names.push_back(with_side(name, side));
            }
        const motion::FoundBones found = motion::find_bones(names);
        EXPECT_EQ(found.missing(), "") << naming.program;
        for (const auto& [kind, name] : naming.bones) {
            if (kind == kOther) continue;
            const bool sided = name.find('%') != std::string::npos;
            for (const Side side : {Side::kRight, Side::kLeft}) {
                if (!sided && side == Side::kLeft) continue;
                ASSERT_TRUE(found.has(kind, side)) << naming.program << ": " << name;
                EXPECT_EQ(names[found.of(kind, side)],
                          with_side(name, side == Side::kRight ? naming.right : naming.left))
                    << naming.program;
            }
        }
    }
}

// Most bones are fingers, whose names begin as that of the hand.
TEST(BoneNames, AWordThatMostShareMayBeABone) {
    std::vector<std::string> names = {"Hand_L", "Hand_R"};
    for (const char* finger : {"Thumb", "Index", "Middle", "Ring", "Pinky"})
        for (const char* side : {"L", "R"}) names.push_back(fmt::format("Hand_{}_1_{}", finger, side));
    const motion::FoundBones found = motion::find_bones(names);
    ASSERT_TRUE(found.has(motion::kHand, Side::kLeft));
    EXPECT_EQ(names[found.of(motion::kHand, Side::kLeft)], "Hand_L");
    ASSERT_TRUE(found.has(motion::kHand, Side::kRight));
    EXPECT_EQ(names[found.of(motion::kHand, Side::kRight)], "Hand_R");
}

TEST(BoneNames, SayWhatIsMissing) {
    const std::vector<std::string> names = {"Hips", "Head", "LeftArm", "LeftForeArm", "", "LeftHandThumb1"};
    EXPECT_EQ(motion::find_bones(names).missing(),
              "right upper arm, right forearm, right hand, left hand, right shin, left shin, right thigh, left thigh, "
              "right foot, left foot");
}

}  // namespace
}  // namespace neuvv
