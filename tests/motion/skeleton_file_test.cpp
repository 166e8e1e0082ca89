#include "motion/skeleton/skeleton_file.h"

#include <gtest/gtest.h>

#include "motion/detector.h"
#include "motion/skeleton/humanoid.h"
#include "stage/gltf/glb_writer.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/pose.h"
#include "support/input_error.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

using motion::Joint;
using motion::kJoints;

motion::JointSample& sample_of(motion::SkeletonClip& clip, size_t frame, Joint joint) {
    return motion::at(clip.frames[frame], joint);
}

void expect_same(const motion::SkeletonClip& a, const motion::SkeletonClip& b, double within) {
    EXPECT_DOUBLE_EQ(a.fps, b.fps);
    ASSERT_EQ(a.frames.size(), b.frames.size());
    for (size_t f = 0; f < a.frames.size(); ++f)
        for (size_t j = 0; j < kJoints; ++j) {
            EXPECT_NEAR(a.frames[f][j].confidence, b.frames[f][j].confidence, 0.005);
            EXPECT_EQ(a.frames[f][j].measured, b.frames[f][j].measured);
            if (b.frames[f][j].confidence > 0)
                test::expect_near(a.frames[f][j].position, b.frames[f][j].position, within);
        }
}

TEST(SkeletonFile, KeepsPositionsConfidenceAndOrigin) {
    const TemporaryFolder folder;
    motion::SkeletonClip clip = test::performer_motion(20);
    sample_of(clip, 3, Joint::kLeftWrist) = {glm::dvec3(5), 0, false};
    sample_of(clip, 0, Joint::kNose) = {};
    sample_of(clip, 7, Joint::kRightKnee).confidence = 0.37;
    sample_of(clip, 7, Joint::kRightKnee).measured = false;
    for (size_t f = 0; f < 20; ++f) sample_of(clip, f, Joint::kLeftHeel).confidence = 0;
    motion::write_skeleton(folder.path / "a.skeleton.glb", clip);
    expect_same(motion::read_skeleton(folder.path / "a.skeleton.glb"), clip, 1e-5);
}

TEST(SkeletonFile, KeepsASingleFrame) {
    const TemporaryFolder folder;
    const motion::SkeletonClip clip = test::performer_motion(1);
    motion::write_skeleton(folder.path / "a.glb", clip);
    expect_same(motion::read_skeleton(folder.path / "a.glb"), clip, 1e-5);
}

// What other programs see: a skinned mesh of bones whose ends are the joints.
TEST(SkeletonFile, IsAGltfWhoseBonesMove) {
    const TemporaryFolder folder;
    const motion::SkeletonClip clip = test::performer_motion(30);
    motion::write_skeleton(folder.path / "a.glb", clip);
    const stage::GltfScene scene = stage::load_gltf(folder.path / "a.glb");
    ASSERT_EQ(scene.skins.size(), 1u);
    EXPECT_EQ(scene.skins[0].joints.size(), kJoints);
    const auto mesh_node = static_cast<uint32_t>(kJoints);
    const stage::GltfPrimitive& primitive = scene.meshes[0].primitives[0];
    stage::PosedVertices vertices;
    for (const size_t f : {size_t{0}, size_t{13}, size_t{29}}) {
        const stage::PosedScene pose = stage::pose_scene(scene, 0, static_cast<double>(f) / clip.fps);
        stage::pose_vertices(scene, pose, mesh_node, primitive, vertices);
        // Eight triangles a bone, whose vertices were parted for flat normals: the first vertex is at the parent, the
        // fourth at the joint. The pelvis has no bone.
        for (size_t j = 1; j < kJoints; ++j) {
            const Joint parent = motion::info_of(motion::joint_at(j)).parent;
            test::expect_near(vertices.positions[24 * (j - 1)], motion::at(clip.frames[f], parent).position, 1e-4);
            test::expect_near(vertices.positions[24 * (j - 1) + 3], clip.frames[f][j].position, 1e-4);
        }
    }
}

TEST(SkeletonFile, RefusesWhatIsNotWhole) {
    const TemporaryFolder folder;
    const auto path = folder.path / "a.glb";
    motion::write_skeleton(path, test::performer_motion(4));
    const std::string good = read_text(path);
    const auto refuses = [&](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
        ASSERT_EQ(from.size(), to.size());
        std::string bad = good;
        const size_t at = bad.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        write_text(path, bad.replace(at, from.size(), to));
        expect_input_error([&] { motion::read_skeleton(path); }, parts);
    };
    refuses("\"version\":1,", "\"version\":7,", {"a.glb", "NEUVV_skeleton.version", "update"});
    refuses("\"fps\":25.0", "\"fps\":-5.0", {"a.glb", "NEUVV_skeleton.fps"});
    refuses("\"measured\":[2", "\"measured\":[9", {"a.glb", "measured[0]"});
    refuses("\"confidence\":[[100", "\"confidence\":[[900", {"a.glb", "confidence[0][0]", "percentage"});
    refuses("\"left_wrist\"", "\"left_wriSt\"", {"a.glb", "left_wrist"});
    EXPECT_EQ(motion::skeleton_beside("b/performer.nvv"), "b/performer.skeleton.glb");
    expect_input_error([&] { motion::read_skeleton(folder.path / "a.fbx"); }, {"a.fbx", ".bvh"});
}

TEST(ModelMotion, FindsJointsInBonesAndSkin) {
    const motion::SkeletonClip clip = test::performer_motion(1);
    const motion::Pose& pose = clip.frames[0];
    for (const motion::JointSample& sample : pose) EXPECT_TRUE(sample.measured && sample.confidence == 1);
    const auto height = [&](Joint joint) { return motion::at(pose, joint).position.y; };
    EXPECT_GT(height(Joint::kNose), height(Joint::kNeck) + 0.1);
    for (const Joint toe : {Joint::kLeftBigToe, Joint::kRightSmallToe, Joint::kLeftHeel})
        EXPECT_LT(height(toe), height(Joint::kLeftAnkle)) << motion::info_of(toe).name;
    // Feet point forwards: from the heel to the toes is where the nose is.
    const glm::dvec3 foot = motion::at(pose, Joint::kLeftBigToe).position - motion::at(pose, Joint::kLeftHeel).position;
    EXPECT_GT(glm::length(foot), 0.15);
    EXPECT_LT(glm::length(foot), 0.35);
    EXPECT_NEAR(test::height_of(clip), 1.7, 0.15);
}

struct VrmBone {
    const char* name;
    int parent;
    glm::dvec3 from_parent;
};
// A T-pose, whose left side is at +x.
const std::vector<VrmBone> kVrmBones = {{"hips", -1, {0, 1, 0}},
                                        {"spine", 0, {0, 0.3, 0}},
                                        {"head", 1, {0, 0.3, 0}},
                                        {"leftUpperArm", 1, {0.15, 0.2, 0}},
                                        {"leftLowerArm", 3, {0.3, 0, 0}},
                                        {"leftHand", 4, {0.25, 0, 0}},
                                        {"rightUpperArm", 1, {-0.15, 0.2, 0}},
                                        {"rightLowerArm", 6, {-0.3, 0, 0}},
                                        {"rightHand", 7, {-0.25, 0, 0}},
                                        {"leftUpperLeg", 0, {0.1, 0, 0}},
                                        {"leftLowerLeg", 9, {0, -0.45, 0}},
                                        {"leftFoot", 10, {0, -0.45, 0}},
                                        {"rightUpperLeg", 0, {-0.1, 0, 0}},
                                        {"rightLowerLeg", 12, {0, -0.45, 0}},
                                        {"rightFoot", 13, {0, -0.45, 0}}};

// A body whose left arm sinks to the side within a second. The nodes' names say nothing, or the wrong thing.
stage::GlbWriter vrm_body() {
    stage::GlbWriter glb;
    nlohmann::ordered_json nodes = nlohmann::ordered_json::array();
    for (size_t i = 0; i < kVrmBones.size(); ++i) {
        const glm::dvec3& at = kVrmBones[i].from_parent;
        nodes.push_back({{"name", "joint " + std::to_string(7 * i % 15)}, {"translation", {at.x, at.y, at.z}}});
        if (kVrmBones[i].parent >= 0) nodes[static_cast<size_t>(kVrmBones[i].parent)]["children"].push_back(i);
    }
    nodes[5]["name"] = "rightHand";
    nodes[8]["name"] = "leftHand";
    glb.json["nodes"] = nodes;
    glb.json["scenes"] = {{{"nodes", {0}}}};
    const size_t times = glb.add_times({0, 1});
    const float half = std::sqrt(0.5f);
    const size_t turns = glb.add(std::vector<float>{0, 0, 0, 1, 0, 0, -half, half}, "VEC4", 4, stage::kGltfFloat);
    nlohmann::ordered_json animation;
    stage::add_gltf_channel(animation, times, turns, 3, "rotation");
    glb.json["animations"] = {animation};
    return glb;
}

void expect_arm_sinks(const std::filesystem::path& file) {
    const motion::SkeletonClip clip = motion::read_skeleton(file);
    ASSERT_EQ(clip.frames.size(), 11u);  // of the least rate
    const auto place = [&](size_t frame, Joint joint) { return motion::at(clip.frames[frame], joint).position; };
    test::expect_near(place(0, Joint::kLeftWrist), {0.7, 1.5, 0}, 1e-6);
    test::expect_near(place(10, Joint::kLeftElbow), {0.15, 1.2, 0}, 1e-6);
    test::expect_near(place(10, Joint::kLeftWrist), {0.15, 0.95, 0}, 1e-6);
    test::expect_near(place(10, Joint::kRightWrist), {-0.7, 1.5, 0}, 1e-6);
    test::expect_near(place(10, Joint::kRightAnkle), {-0.1, 0.1, 0}, 1e-6);
    EXPECT_GT(place(0, Joint::kNose).y, 1.6);
}

TEST(ModelMotion, OfVrm0AndVrm1GoesByTheirMapOfBones) {
    const TemporaryFolder folder;
    stage::GlbWriter glb = vrm_body();
    nlohmann::ordered_json of_vrm0 = nlohmann::ordered_json::array(), of_vrm1;
    for (size_t i = 0; i < kVrmBones.size(); ++i) {
        of_vrm0.push_back({{"bone", kVrmBones[i].name}, {"node", i}, {"useDefaultValues", true}});
        of_vrm1[kVrmBones[i].name] = {{"node", i}};
    }
    glb.write(folder.path / "bare.vrm", "");
    expect_input_error([&] { motion::read_skeleton(folder.path / "bare.vrm"); }, {"bare.vrm"});
    glb.json["extensions"]["VRM"] = {{"specVersion", "0.0"}, {"humanoid", {{"humanBones", of_vrm0}}}};
    glb.json["extensionsUsed"] = {"VRM"};
    glb.write(folder.path / "0.vrm", "");
    expect_arm_sinks(folder.path / "0.vrm");
    for (const char* extension : {"VRMC_vrm", "VRMC_vrm_animation"}) {
        glb.json["extensions"] = {{extension, {{"specVersion", "1.0"}, {"humanoid", {{"humanBones", of_vrm1}}}}}};
        glb.json["extensionsUsed"] = {extension};
        glb.write(folder.path / "1.vrm", "");
        expect_arm_sinks(folder.path / "1.vrm");
    }
    // Nodes that are not there are passed over.
    glb.json["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"]["neck"] = {{"node", 99}};
    glb.write(folder.path / "1.vrma", "");
    expect_arm_sinks(folder.path / "1.vrma");
}

TEST(Humanoid, KnowsNamesOfManyPrograms) {
    // Hips, head, upper arm, forearm, hand, thigh, shin, foot; % is the side.
    struct Naming {
        const char *hips, *head, *sided[6], *right, *left;
    };
    const Naming namings[] = {
        {"hips", "head", {"%UpperArm", "%LowerArm", "%Hand", "%UpperLeg", "%LowerLeg", "%Foot"}, "right", "left"},
        {"mixamorig:Hips",
         "mixamorig:Head",
         {"mixamorig:%Arm", "mixamorig:%ForeArm", "mixamorig:%Hand", "mixamorig:%UpLeg", "mixamorig:%Leg",
          "mixamorig:%Foot"},
         "Right",
         "Left"},
        {"pelvis", "head", {"upperarm_%", "lowerarm_%", "hand_%", "thigh_%", "calf_%", "foot_%"}, "r", "l"},
        {"Hip", "Head", {"%Shldr", "%ForeArm", "%Hand", "%Thigh", "%Shin", "%Foot"}, "r", "l"},
        {"hips", "head", {"upper_arm.%", "forearm.%", "hand.%", "thigh.%", "shin.%", "foot.%"}, "R", "L"},
        {"Hips", "Head", {"%UpArm", "%LowArm", "%Hand", "%UpLeg", "%LowLeg", "%Foot"}, "Right", "Left"},
        {"Hips", "Head", {"%Shoulder", "%Elbow", "%Wrist", "%Hip", "%Knee", "%Ankle"}, "Right", "Left"},
        {"J_Bip_C_Hips",
         "J_Bip_C_Head",
         {"J_Bip_%_UpperArm", "J_Bip_%_LowerArm", "J_Bip_%_Hand", "J_Bip_%_UpperLeg", "J_Bip_%_LowerLeg",
          "J_Bip_%_Foot"},
         "R",
         "L"},
    };
    const glm::dvec3 places[] = {{0.2, 1.4, 0}, {0.5, 1.4, 0}, {0.75, 1.4, 0},
                                 {0.1, 0.9, 0}, {0.1, 0.5, 0}, {0.1, 0.1, 0}};
    for (const Naming& naming : namings) {
        std::vector<motion::RestBone> bones(2);
        bones[0].name = naming.hips;
        bones[1].name = naming.head;
        bones[1].world_from_bone[3] = {0, 1.6, 0, 1};
        for (const bool left : {false, true})
            for (size_t i = 0; i < 6; ++i) {
                motion::RestBone bone;
                bone.name = naming.sided[i];
                bone.name.replace(bone.name.find('%'), 1, left ? naming.left : naming.right);
                bone.world_from_bone[3] = glm::dvec4(places[i] * glm::dvec3(left ? 1 : -1, 1, 1), 1);
                bones.push_back(bone);
            }
        std::vector<glm::dmat4> world;
        for (const motion::RestBone& bone : bones) world.push_back(bone.world_from_bone);
        const motion::Pose pose = motion::pose_of(motion::joint_sources(bones, "model"), world);
        test::expect_near(motion::at(pose, Joint::kLeftElbow).position, {0.5, 1.4, 0});
        test::expect_near(motion::at(pose, Joint::kRightKnee).position, {-0.1, 0.5, 0});
        test::expect_near(motion::at(pose, Joint::kNeck).position, {0, 1.4, 0});
        EXPECT_GT(motion::at(pose, Joint::kLeftBigToe).position.z, 0.1) << "forwards of " << naming.hips;
        EXPECT_FALSE(motion::at(pose, Joint::kLeftBigToe).measured);
    }
    std::vector<motion::RestBone> nobody(1);
    nobody[0].name = "hips";
    expect_input_error([&] { motion::joint_sources(nobody, "model"); },
                       {"model", "head", "right upper arm", "left foot"});
}

}  // namespace
}  // namespace neuvv
