#include "motion/live/vmc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "base/error.h"
#include "motion/live/osc.h"
#include "motion/skeleton/bone_names.h"

namespace neuvv::motion {

namespace {

constexpr double kFarthestBone_m = 1e4;
constexpr const char* kBonePath = "/VMC/Ext/Bone/Pos";
constexpr const char* kRootPath = "/VMC/Ext/Root/Pos";
constexpr const char* kStatusPath = "/VMC/Ext/OK";
constexpr const char* kPaths[] = {kBonePath, kRootPath, kStatusPath};

// The bones of VRM by the names of Unity. Parents stand before their children.
struct VmcBone {
    const char* name;
    int parent;  // −1: the root
};
constexpr std::array<VmcBone, kVmcBones> kBones = {{
    {"Hips", -1},          {"Spine", 0},         {"Chest", 1},         {"UpperChest", 2},    {"Neck", 3},
    {"Head", 4},           {"RightShoulder", 3}, {"RightUpperArm", 6}, {"RightLowerArm", 7}, {"RightHand", 8},
    {"LeftShoulder", 3},   {"LeftUpperArm", 10}, {"LeftLowerArm", 11}, {"LeftHand", 12},     {"RightUpperLeg", 0},
    {"RightLowerLeg", 14}, {"RightFoot", 15},    {"RightToes", 16},    {"LeftUpperLeg", 0},  {"LeftLowerLeg", 18},
    {"LeftFoot", 19},      {"LeftToes", 20},
}};

double number_in(const OscMessage& message, size_t i, double low, double high, const std::string& stream) {
    const double* number = i < message.arguments.size() ? std::get_if<double>(&message.arguments[i]) : nullptr;
    if (!number || !(*number >= low && *number <= high))
        throw InputError(stream, message.path, fmt::format("argument {} is no number from {} to {}", i + 1, low, high));
    return *number;
}

const std::string& name_in(const OscMessage& message, const std::string& stream) {
    const std::string* name = message.arguments.empty() ? nullptr : std::get_if<std::string>(&message.arguments[0]);
    if (!name) throw InputError(stream, message.path, "has no name as its first argument");
    return *name;
}

}  // namespace

bool VmcBody::read(std::span<const uint8_t> packet, const std::string& stream, bool status_counts) {
    // Unity's space is left-handed; ours is its mirror image, x to −x. Rotations about x keep their angle.
    const auto transform_in = [&](const OscMessage& message) {
        std::array<double, 7> v{};
        for (size_t i = 0; i < v.size(); ++i) {
            const double limit = i < 3 ? kFarthestBone_m : 2;
            v[i] = number_in(message, i + 1, -limit, limit, stream);
        }
        const glm::dquat turn(v[6], v[3], -v[4], -v[5]);
        if (!(glm::length(turn) > 0.5 && glm::length(turn) < 2))
            throw InputError(stream, message.path, "has a quaternion whose length is not 1");
        return Transform{{-v[0], v[1], v[2]}, glm::normalize(turn)};
    };
    std::vector<BoneMove> moves;
    std::optional<Transform> root;
    std::optional<bool> tracked;
    const std::vector<OscMessage> messages = read_osc(packet, kPaths, stream);
    for (const OscMessage& message : messages) {
        if (message.path == kStatusPath) {
            const auto flag = [&](size_t i) { return number_in(message, i, INT32_MIN, INT32_MAX, stream); };
            const size_t count = message.arguments.size();
            const bool calibrating = count > 1 && (flag(1) == 1 || flag(1) == 2);
            tracked = flag(0) != 0 && !calibrating && (count < 4 || flag(3) != 0);
            continue;
        }
        const Transform transform = transform_in(message);
        const auto bone = std::ranges::find(kBones, name_in(message, stream), &VmcBone::name);
        if (message.path == kRootPath)
            root = transform;
        else if (bone != kBones.end())  // fingers and eyes are no bones here
            moves.push_back({static_cast<size_t>(bone - kBones.begin()), transform});
    }
    // Nothing of the packet is malformed: now it is taken.
    if (status_counts || !moves.empty()) tracked_ = tracked.value_or(tracked_);
    root_ = root.value_or(root_);
    for (const BoneMove& bone_move : moves) move(bone_move);
    if (packet[0] == '#') end_pose();
    return !moves.empty();
}

void VmcBody::move(const BoneMove& move) {
    if (came_[move.bone]) end_pose();
    Transform& local = local_[move.bone];
    // Where the hips are, and how any bone is turned, says nothing of the body at rest.
    if (!known_[move.bone] || (move.bone != 0 && local.place != move.local.place)) sources_.reset();
    local = move.local;
    whole_ = whole_ || known_[move.bone];
    known_.set(move.bone);
    came_.set(move.bone);
}

void VmcBody::end_pose() {
    ended_ += came_.any();
    came_.reset();
}

// Bones that never came stay where their parents are, so that their children find the nearest one that did.
std::array<glm::dmat4, kVmcBones> VmcBody::world_from_bones() const {
    const auto matrix = [](const Transform& transform) {
        return glm::translate(glm::dmat4(1), transform.place) * glm::mat4_cast(transform.turn);
    };
    std::array<glm::dmat4, kVmcBones> world;
    for (size_t b = 0; b < kVmcBones; ++b) {
        const glm::dmat4 parent = kBones[b].parent < 0 ? matrix(root_) : world[static_cast<size_t>(kBones[b].parent)];
        world[b] = known_[b] ? parent * matrix(local_[b]) : parent;
    }
    return world;
}

std::optional<VmcBody::Poses> VmcBody::take(const std::string& stream) {
    end_pose();
    const uint64_t count = std::exchange(ended_, 0);
    if (count == 0) return std::nullopt;
    if (!tracked_)
        throw InputError(stream, kStatusPath, "says that no body is tracked",
                         "load a model and calibrate it in the program that sends");
    if (!sources_) {
        // At rest no bone of VRM is turned.
        VmcBody rest;
        rest.known_ = known_;
        for (size_t b = 1; b < kVmcBones; ++b) rest.local_[b].place = local_[b].place;
        const std::array<glm::dmat4, kVmcBones> world = rest.world_from_bones();
        std::vector<RestBone> bones;
        for (size_t b = 0; b < kVmcBones; ++b) bones.push_back({known_[b] ? kBones[b].name : "", world[b], {}});
        std::vector<std::string> names;
        for (const RestBone& bone : bones) names.push_back(bone.name);
        if (const std::string missing = find_bones(names).missing(); !missing.empty()) {
            if (!whole_) return std::nullopt;  // the rest of the body is still on its way
            throw InputError(stream, kBonePath, "has no " + missing,
                             "let the program that sends track the whole body, not the face or the hands alone");
        }
        try {
            sources_ = joint_sources(bones, stream);
        } catch (const InputError&) {
            if (!whole_) return std::nullopt;
            throw;
        }
    }
    return Poses{pose_of(*sources_, world_from_bones()), count};
}

}  // namespace neuvv::motion
