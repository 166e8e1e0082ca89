#include "tools/bench/vmc_sender.h"

#include <bit>
#include <glm/gtc/quaternion.hpp>

namespace neuvv::bench {

namespace {

using motion::Joint;

// A bone of the protocol in a body that stands at rest with its arms stretched out and looks along +Z.
struct SentBone {
    const char* name;
    int parent;              // index into kSentBones
    Joint at;                // where the bone begins; its distance to the parent's is that joint's bone length
    glm::dvec3 from_parent;  // unit
    Joint towards;           // where the bone leads; the pelvis: turned as the trunk; its own: as its parent
    glm::dvec3 along;        // unit, at rest
};
constexpr glm::dvec3 kLeft(1, 0, 0), kRight(-1, 0, 0), kUp(0, 1, 0), kDown(0, -1, 0);
constexpr Joint kAsTrunk = Joint::kPelvis;
constexpr std::array<SentBone, 15> kSentBones = {{
    {"Hips", -1, Joint::kPelvis, kUp, kAsTrunk, kUp},
    {"UpperChest", 0, Joint::kNeck, kUp, kAsTrunk, kUp},
    {"Head", 1, Joint::kNose, kUp, kAsTrunk, kUp},
    {"RightUpperArm", 1, Joint::kRightShoulder, kRight, Joint::kRightElbow, kRight},
    {"RightLowerArm", 3, Joint::kRightElbow, kRight, Joint::kRightWrist, kRight},
    {"RightHand", 4, Joint::kRightWrist, kRight, Joint::kRightWrist, kRight},
    {"LeftUpperArm", 1, Joint::kLeftShoulder, kLeft, Joint::kLeftElbow, kLeft},
    {"LeftLowerArm", 6, Joint::kLeftElbow, kLeft, Joint::kLeftWrist, kLeft},
    {"LeftHand", 7, Joint::kLeftWrist, kLeft, Joint::kLeftWrist, kLeft},
    {"RightUpperLeg", 0, Joint::kRightHip, kRight, Joint::kRightKnee, kDown},
    {"RightLowerLeg", 9, Joint::kRightKnee, kDown, Joint::kRightAnkle, kDown},
    {"RightFoot", 10, Joint::kRightAnkle, kDown, Joint::kRightAnkle, kDown},
    {"LeftUpperLeg", 0, Joint::kLeftHip, kLeft, Joint::kLeftKnee, kDown},
    {"LeftLowerLeg", 12, Joint::kLeftKnee, kDown, Joint::kLeftAnkle, kDown},
    {"LeftFoot", 13, Joint::kLeftAnkle, kDown, Joint::kLeftAnkle, kDown},
}};

// The axes of the trunk at the hips or at the shoulders: left, up, forward.
glm::dquat trunk_at(const motion::Pose& pose, Joint right) {
    const auto place = [&pose](Joint joint) { return motion::at(pose, joint).position; };
    const glm::dvec3 x = glm::normalize(place(motion::info_of(right).mirrored) - place(right));
    const glm::dvec3 z = glm::normalize(glm::cross(x, place(Joint::kNeck) - place(Joint::kPelvis)));
    return glm::quat_cast(glm::dmat3(x, glm::cross(z, x), z));
}

// How each bone is turned in the world: without twist against its parent.
std::array<glm::dquat, kSentBones.size()> turns_of(const motion::Pose& pose) {
    std::array<glm::dquat, kSentBones.size()> turns;
    for (size_t b = 0; b < kSentBones.size(); ++b) {
        const SentBone& bone = kSentBones[b];
        if (bone.towards == kAsTrunk) {
            turns[b] = trunk_at(pose, b == 0 ? Joint::kRightHip : Joint::kRightShoulder);
            continue;
        }
        const glm::dquat& parent = turns[static_cast<size_t>(bone.parent)];
        const glm::dvec3 along = motion::at(pose, bone.towards).position - motion::at(pose, bone.at).position;
        turns[b] = bone.towards == bone.at ? parent : glm::dquat(parent * bone.along, glm::normalize(along)) * parent;
    }
    return turns;
}

// OSC: numbers are big-endian, and texts end with 1 to 4 zeros at a multiple of 4.
void add_number(std::vector<uint8_t>& bytes, uint32_t number) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<uint8_t>(number >> shift));
}

void add_osc_text(std::vector<uint8_t>& bytes, const std::string& text) {
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.resize(bytes.size() + 4 - text.size() % 4);
}

}  // namespace

std::vector<uint8_t> vmc_packet(const motion::Pose& pose, const std::array<double, motion::kJoints>& lengths) {
    const std::array<glm::dquat, kSentBones.size()> turns = turns_of(pose);
    std::vector<uint8_t> packet;
    add_osc_text(packet, "#bundle");
    add_number(packet, 0);
    add_number(packet, 1);  // at once
    for (size_t b = 0; b < kSentBones.size(); ++b) {
        const SentBone& bone = kSentBones[b];
        const bool root = bone.parent < 0;
        const glm::dvec3 place =
            root ? motion::at(pose, bone.at).position : lengths[motion::index_of(bone.at)] * bone.from_parent;
        const glm::dquat turn = root ? turns[b] : glm::inverse(turns[static_cast<size_t>(bone.parent)]) * turns[b];
        std::vector<uint8_t> message;
        add_osc_text(message, "/VMC/Ext/Bone/Pos");
        add_osc_text(message, ",sfffffff");
        add_osc_text(message, bone.name);
        // Unity's space is the mirror image of ours, x to −x.
        for (const double number : {-place.x, place.y, place.z, turn.x, -turn.y, -turn.z, turn.w})
            add_number(message, std::bit_cast<uint32_t>(static_cast<float>(number)));
        add_number(packet, static_cast<uint32_t>(message.size()));
        packet.insert(packet.end(), message.begin(), message.end());
    }
    return packet;
}

VmcSender::VmcSender(const std::string& listener)
    : output_(static_cast<uint16_t>(std::stoul(listener.substr(listener.rfind(':') + 1)))) {}

}  // namespace neuvv::bench
