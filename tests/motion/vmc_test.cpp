// Packets of the VMC protocol: whose pose they are, and that none of them does harm.
#include "motion/live/vmc.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include "motion/live/osc.h"
#include "motion/senders.h"
#include "support/input_error.h"

namespace neuvv {
namespace {

using motion::Joint;
using motion::VmcBody;
using test::VmcPart;

// A body of Unity, which is left-handed: +Y is up, it faces +Z, and its left is at −X.
struct UnityBone {
    std::string name, parent;
    glm::dvec3 place;             // of the parent
    glm::dvec4 turn{0, 0, 0, 1};  // x, y, z, w
};

glm::dvec4 turn_about(const glm::dvec3& axis, double degrees) {
    const double half = degrees * M_PI / 360;
    return {glm::normalize(axis) * std::sin(half), std::cos(half)};
}

std::vector<UnityBone> unity_body() {
    std::vector<UnityBone> bones = {
        {"Hips", "", {0.1, 0.95, -0.2}, turn_about({0.2, 1, 0.1}, 40)},
        {"Spine", "Hips", {0, 0.1, 0.01}, turn_about({1, 0, 0}, 12)},
        {"Chest", "Spine", {0, 0.12, 0}, turn_about({0, 0, 1}, -9)},
        {"UpperChest", "Chest", {0, 0.1, 0}},
        {"Neck", "UpperChest", {0, 0.15, 0}},
        {"Head", "Neck", {0, 0.1, 0.01}, turn_about({0, 1, 0}, 25)},
    };
    for (const std::string side : {"Left", "Right"}) {
        const double out = side == "Left" ? -1 : 1;
        const std::vector<UnityBone> limbs = {
            {"Shoulder", "UpperChest", {out * 0.04, 0.1, 0}, turn_about({0, 0, 1}, out * 5)},
            {"UpperArm", side + "Shoulder", {out * 0.12, 0, 0}, turn_about({0.3, 1, out}, 60)},
            {"LowerArm", side + "UpperArm", {out * 0.27, 0, 0}, turn_about({0, 1, 0}, out * -70)},
            {"Hand", side + "LowerArm", {out * 0.25, 0, 0}},
            {"UpperLeg", "Hips", {out * 0.09, -0.05, 0}, turn_about({1, 0.2, 0}, out * 20)},
            {"LowerLeg", side + "UpperLeg", {0, -0.42, 0}, turn_about({1, 0, 0}, 35)},
            {"Foot", side + "LowerLeg", {0, -0.4, -0.02}, turn_about({0, 1, 0}, 10)},
            {"Toes", side + "Foot", {0, -0.07, 0.12}}};
        for (UnityBone bone : limbs) {
            bone.name = side + bone.name;
            bones.push_back(bone);
        }
    }
    return bones;
}

VmcPart part_of(const UnityBone& bone) {
    VmcPart part{"/VMC/Ext/Bone/Pos", bone.name, {}};
    for (int i = 0; i < 3; ++i) part.numbers.push_back(static_cast<float>(bone.place[i]));
    for (int i = 0; i < 4; ++i) part.numbers.push_back(static_cast<float>(bone.turn[i]));
    return part;
}

std::vector<VmcPart> parts_of(const std::vector<UnityBone>& bones) {
    std::vector<VmcPart> parts;
    for (const UnityBone& bone : bones) parts.push_back(part_of(bone));
    return parts;
}

std::span<const uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

bool read(VmcBody& body, const std::string& packet) {
    return body.read(bytes_of(packet), "test");
}

// Rodrigues' formula for a quaternion, in whichever handedness: v + 2 q × (q × v + w v).
glm::dvec3 turned_by(const glm::dvec4& turn, const glm::dvec3& v) {
    const glm::dvec3 q(turn);
    return v + 2.0 * glm::cross(q, glm::cross(q, v) + turn.w * v);
}

// Where a bone is in Unity's space: from the bone up to the root, a parent at a time.
glm::dvec3 unity_place(const std::vector<UnityBone>& bones, const std::string& name) {
    std::map<std::string, UnityBone> by_name;
    for (const UnityBone& bone : bones) by_name[bone.name] = bone;
    glm::dvec3 place(0);
    for (std::string at = name; !at.empty(); at = by_name[at].parent)
        place = by_name[at].place + turned_by(by_name[at].turn, place);
    return place;
}

glm::dvec3 mirrored(const glm::dvec3& unity) {
    return {-unity.x, unity.y, unity.z};
}

void expect_near(const glm::dvec3& found, const glm::dvec3& truth, const std::string& what) {
    EXPECT_LT(glm::distance(found, truth), 1e-5)  // numbers come in single precision
        << what << ": " << found.x << ' ' << found.y << ' ' << found.z << " not " << truth.x << ' ' << truth.y << ' '
        << truth.z;
}

const std::map<std::string, Joint> kJointsOfBones = {
    {"RightUpperArm", Joint::kRightShoulder}, {"RightLowerArm", Joint::kRightElbow}, {"RightHand", Joint::kRightWrist},
    {"LeftUpperArm", Joint::kLeftShoulder},   {"LeftLowerArm", Joint::kLeftElbow},   {"LeftHand", Joint::kLeftWrist},
    {"RightUpperLeg", Joint::kRightHip},      {"RightLowerLeg", Joint::kRightKnee},  {"RightFoot", Joint::kRightAnkle},
    {"LeftUpperLeg", Joint::kLeftHip},        {"LeftLowerLeg", Joint::kLeftKnee},    {"LeftFoot", Joint::kLeftAnkle},
};

void expect_joints(const motion::Pose& pose, const std::vector<UnityBone>& bones) {
    for (const auto& [bone, joint] : kJointsOfBones) {
        expect_near(at(pose, joint).position, mirrored(unity_place(bones, bone)), bone);
        EXPECT_TRUE(at(pose, joint).measured);
    }
}

TEST(Vmc, ABodyOfUnityArrivesMirrored) {
    const std::vector<UnityBone> bones = unity_body();
    VmcBody body;
    EXPECT_TRUE(read(body, test::vmc_bundle(parts_of(bones))));
    const auto poses = body.take("test");
    ASSERT_TRUE(poses);
    EXPECT_EQ(poses->count, 1u);
    expect_joints(poses->newest, bones);
    for (const Joint joint : {Joint::kNose, Joint::kLeftHeel, Joint::kRightSmallToe}) {
        EXPECT_FALSE(at(poses->newest, joint).measured) << "placed by proportions";
        EXPECT_EQ(at(poses->newest, joint).confidence, 1);
    }
    EXPECT_FALSE(body.take("test")) << "nothing new";
}

// Numbers that need no formula: a T-pose, then the left forearm up, then forwards.
TEST(Vmc, LeftIsLeftAndForwardsIsForwards) {
    std::vector<UnityBone> bones = unity_body();
    for (UnityBone& bone : bones) bone.turn = {0, 0, 0, 1};
    const auto pose_with = [&](const glm::dvec4& forearm) {
        for (UnityBone& bone : bones)
            if (bone.name == "LeftLowerArm") bone.turn = forearm;
        VmcBody body;
        read(body, test::vmc_bundle(parts_of(bones)));
        return body.take("test")->newest;
    };
    const motion::Pose still = pose_with({0, 0, 0, 1});
    const auto wrist_from_elbow = [](const motion::Pose& pose) {
        return at(pose, Joint::kLeftWrist).position - at(pose, Joint::kLeftElbow).position;
    };
    expect_near(wrist_from_elbow(still), {0.25, 0, 0}, "+X is the left of who faces +Z");
    EXPECT_GT(at(still, Joint::kNose).position.z, at(still, Joint::kNeck).position.z + 0.05);
    EXPECT_GT(at(still, Joint::kLeftBigToe).position.z, at(still, Joint::kLeftAnkle).position.z + 0.05);
    EXPECT_LT(at(still, Joint::kLeftHeel).position.z, at(still, Joint::kLeftAnkle).position.z);
    // Left-handed turns from −X: by −90° about Z upwards, by +90° about Y forwards.
    expect_near(wrist_from_elbow(pose_with(turn_about({0, 0, 1}, -90))), {0, 0.25, 0}, "up");
    expect_near(wrist_from_elbow(pose_with(turn_about({0, 1, 0}, 90))), {0, 0, 0.25}, "forwards");
}

TEST(Vmc, BonesThatAModelLacksArePassedOver) {
    std::vector<UnityBone> bones = unity_body();
    // Without them, the local place of a child is measured from the nearest bone that is there.
    for (const char* name : {"Chest", "UpperChest", "Neck", "LeftShoulder", "RightToes"}) {
        const auto gone = std::ranges::find(bones, name, &UnityBone::name);
        for (UnityBone& bone : bones)
            if (bone.parent == gone->name) bone.parent = gone->parent;
        bones.erase(gone);
    }
    VmcBody body;
    read(body, test::vmc_bundle(parts_of(bones)));
    expect_joints(body.take("test")->newest, bones);
}

TEST(Vmc, TheRootMovesTheBody) {
    std::vector<UnityBone> bones = unity_body();
    const UnityBone root{"root", "", {1, 0.5, -2}, turn_about({0, 1, 0}, 110)};
    VmcPart message = part_of(root);
    message.path = "/VMC/Ext/Root/Pos";
    message.numbers.insert(message.numbers.end(),
                           {1.1f, 1.1f, 1.1f, 0.5f, 0, 0});  // scale and offset of later versions
    std::vector<VmcPart> parts = parts_of(bones);
    parts.insert(parts.begin(), message);
    VmcBody body;
    read(body, test::vmc_bundle(parts));
    bones[0].parent = "root";
    bones.push_back(root);
    expect_joints(body.take("test")->newest, bones);
}

TEST(Vmc, SingleMessagesMakePosesToo) {
    std::vector<UnityBone> bones = unity_body();
    VmcBody body;
    for (const VmcPart& part : parts_of(bones)) {
        EXPECT_TRUE(read(body, test::vmc_packet(part)));
        if (part.name == "Chest") {
            EXPECT_FALSE(body.take("test")) << "the rest is on its way";
        }
    }
    EXPECT_EQ(body.take("test")->count, 1u);
    // Three frames, of which the third has only begun.
    for (int frame = 0; frame < 2; ++frame)
        for (const VmcPart& part : parts_of(bones)) read(body, test::vmc_packet(part));
    bones[0].place.y += 0.1;
    read(body, test::vmc_packet(part_of(bones[0])));
    const auto poses = body.take("test");
    ASSERT_TRUE(poses);
    EXPECT_EQ(poses->count, 3u);
    expect_joints(poses->newest, bones);
    // A body in two bundles, as programs send them that keep packets small.
    const std::vector<VmcPart> parts = parts_of(bones);
    VmcBody halves;
    read(halves, test::vmc_bundle({parts.begin(), parts.begin() + 10}));
    EXPECT_FALSE(halves.take("test"));
    read(halves, test::vmc_bundle({parts.begin() + 10, parts.end()}));
    expect_joints(halves.take("test")->newest, bones);
}

TEST(Vmc, OtherProportionsAreAnotherRestPose) {
    std::vector<UnityBone> bones = unity_body();
    const auto nose_of = [](VmcBody& body) {
        const motion::Pose pose = body.take("test")->newest;
        return glm::distance(at(pose, Joint::kNose).position, at(pose, Joint::kNeck).position);
    };
    VmcBody body, fresh;
    read(body, test::vmc_bundle(parts_of(bones)));
    const double before = nose_of(body);
    for (UnityBone& bone : bones) bone.place *= 2.0;
    read(body, test::vmc_bundle(parts_of(bones)));
    read(fresh, test::vmc_bundle(parts_of(bones)));
    EXPECT_NEAR(nose_of(body), 2 * before, 1e-5);
    EXPECT_NEAR(nose_of(fresh), 2 * before, 1e-5);
}

TEST(Vmc, SaysWhatIsMissing) {
    std::vector<UnityBone> bones = unity_body();
    std::erase_if(bones, [](const UnityBone& bone) { return bone.name.starts_with("LeftUpperLeg"); });
    VmcBody body;
    read(body, test::vmc_bundle(parts_of(bones)));
    EXPECT_FALSE(body.take("test")) << "it may still come";
    read(body, test::vmc_bundle(parts_of(bones)));
    expect_input_error([&] { body.take("test"); }, {"test", "left thigh"});

    VmcBody whole;
    const auto say = [&](const std::vector<float>& status) {
        read(whole, test::vmc_bundle(parts_of(unity_body())));
        EXPECT_FALSE(read(whole, test::vmc_packet({"/VMC/Ext/OK", "", status}))) << "no bones";
        return whole.take("test").has_value();
    };
    EXPECT_TRUE(say({1}));
    EXPECT_TRUE(say({1, 3, 0, 1}));
    for (const std::vector<float>& status : {std::vector<float>{0}, {1, 2, 0, 1}, {1, 3, 0, 0}})
        expect_input_error([&] { say(status); }, {"test", "/VMC/Ext/OK", "no body is tracked"});
    EXPECT_TRUE(say({1, 3, 0}));
}

TEST(Vmc, PassesOverWhatItDoesNotRead) {
    VmcBody body;
    EXPECT_FALSE(read(body, test::vmc_packet({"/VMC/Ext/Blend/Val", "Joy", {0.5f}})));
    EXPECT_FALSE(read(body, test::vmc_packet({"/VMC/Ext/Hmd/Pos", "x", {1, 2}})));
    EXPECT_FALSE(read(body, test::vmc_packet(part_of({"LeftThumbProximal", "", {0, 0, 0}}))));
    EXPECT_FALSE(body.take("test"));
}

// Packets that must be refused, and change nothing.
TEST(Vmc, RefusesMalformedPackets) {
    const std::string sound = test::vmc_packet(part_of(unity_body()[0]));
    const std::string whole = test::vmc_bundle(parts_of(unity_body()));
    VmcBody body;
    read(body, whole);
    body.take("test");
    std::vector<std::string> packets;
    const auto message = [&](const std::string& name, std::vector<float> numbers) {
        packets.push_back(test::vmc_packet({"/VMC/Ext/Bone/Pos", name, std::move(numbers)}));
    };
    for (const float bad : {NAN, INFINITY, -INFINITY, 1e30f})
        for (size_t i = 0; i < 7; ++i) {
            std::vector<float> numbers = {0, 1, 0, 0, 0, 0, 1};
            numbers[i] = bad;
            message("Hips", numbers);
        }
    message("Hips", {0, 1, 0, 0, 0, 0, 0});
    message("Hips", {0, 1, 0, 0, 0, 0, 0.001f});
    message("Hips", {0, 1, 0, 0, 0, 0});
    message("Hips", {});
    message("", {0, 1, 0, 0, 0, 0, 1});
    packets.push_back(test::vmc_packet({"/VMC/Ext/OK", "loaded", {}}));
    packets.push_back("");
    packets.push_back(std::string(4, '\0'));
    packets.push_back(std::string(16, 'a'));
    packets.push_back(std::string("/VMC/Ext/Bone/Pos\0\0\0", 20));                  // without types
    packets.push_back(std::string("/VMC/Ext/Bone/Pos\0\0\0,b\0\0", 24));            // a blob of no size
    packets.push_back(std::string("/VMC/Ext/Bone/Pos\0\0\0sfff\0\0\0\0", 28));      // types without a comma
    packets.push_back(std::string("/VMC/Ext/Bone/Pos\0\0\0,sss\0\0\0\0aaaa", 32));  // a text that does not end
    packets.push_back(std::string("/VMC/Ext/Bone/Pos\0\0\0,", 21) + std::string(4000, 'f') + std::string(3, '\0'));
    // A sound bone before a malformed one is not taken, either.
    packets.push_back(test::vmc_bundle({part_of(unity_body()[0]), {"/VMC/Ext/Bone/Pos", "Spine", {NAN}}}));
    for (size_t i = 0; i < packets.size(); ++i) {
        const std::string& packet = packets[i];
        SCOPED_TRACE(i);
        expect_input_error([&] { read(body, packet); }, {"test"});
        EXPECT_FALSE(body.take("test"));
    }
    // Cut at each length.
    for (const std::string& packet : {sound, whole})
        for (size_t size = 0; size < packet.size(); ++size) {
            VmcBody other;
            const std::string cut = packet.substr(0, size);
            try {
                read(other, cut);
                // A bundle may end after any of its messages.
                EXPECT_EQ(cut[0], '#') << size;
                EXPECT_TRUE(size == 16 || (size - 16) % 4 == 0) << size;
                if (other.take("test")) {
                    EXPECT_GT(size, whole.size() / 2);
                }
            } catch (const InputError&) {
            }
        }
}

std::string nested(const std::string& inner) {
    const auto size = static_cast<uint32_t>(inner.size());
    std::string bytes("#bundle\0\0\0\0\0\0\0\0\1", 16);
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(size >> shift & 0xff);
    return bytes + inner;
}

TEST(Vmc, BundlesNestToALimit) {
    std::string packet = test::vmc_bundle(parts_of(unity_body()));
    for (int levels = 1; levels <= 4; ++levels, packet = nested(packet)) {
        VmcBody body;
        EXPECT_TRUE(read(body, packet));
        EXPECT_EQ(body.take("test")->count, 1u);
    }
    VmcBody body;
    expect_input_error([&] { read(body, packet); }, {"more than four levels"});
    while (packet.size() < 60000) packet = nested(packet);
    expect_input_error([&] { read(body, packet); }, {"more than four levels"});
    // A size beyond the packet, and one that would wrap around.
    for (const char* size : {"\0\0\xff\xfc", "\xff\xff\xff\xfc", "\0\0\0\3"}) {
        std::string wrong = nested(test::vmc_packet(part_of(unity_body()[0])));
        wrong.replace(16, 4, size, 4);
        expect_input_error([&] { read(body, wrong); }, {"test"});
    }
}

// Seeded damage of every kind: only errors or sound poses may come of it. The fuzzer does so for longer.
TEST(Vmc, DamageDoesNoHarm) {
    const std::string sound = test::vmc_bundle(parts_of(unity_body()));
    std::mt19937 random(7);
    size_t refused = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string packet = sound;
        for (size_t changes = 1 + random() % 6; changes > 0; --changes)
            packet[random() % packet.size()] = static_cast<char>(random());
        if (random() % 4 == 0) packet.resize(random() % packet.size());
        VmcBody body;
        try {
            read(body, packet);
            const auto poses = body.take("test");
            if (!poses) continue;
            for (const motion::JointSample& sample : poses->newest)
                ASSERT_TRUE(std::isfinite(glm::length(sample.position)));
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 5000u);
    EXPECT_LT(refused, 20000u);
}

}  // namespace
}  // namespace neuvv
