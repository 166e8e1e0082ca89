// Reading Biovision's BVH: a hierarchy of joints with offsets and channels, then the channels' numbers frame by frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/text.h"
#include "motion/skeleton/humanoid.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/skeleton/words.h"

namespace neuvv::motion {

namespace {

constexpr size_t kMaxBvhJoints = 1000, kMaxBvhChannels = 6;
constexpr double kMaxOffset = 1e6;
constexpr double kRateRounding = 2e-4;
constexpr double kMaxPoses = 5e7;  // joints times frames

enum class Channel : uint8_t { kX, kY, kZ, kTurnX, kTurnY, kTurnZ };

struct BvhJoint {
    std::string name;
    int32_t parent = -1;
    glm::dvec3 offset{0};
    std::vector<Channel> channels;
};

struct BvhHierarchy {
    std::vector<BvhJoint> joints;  // parents first
    size_t channels = 0;
};

glm::dvec3 read_offset(Words& words) {
    words.expect("OFFSET");
    glm::dvec3 offset;
    for (int i = 0; i < 3; ++i) offset[i] = words.number(-kMaxOffset, kMaxOffset);
    return offset;
}

Channel read_channel(Words& words) {
    constexpr const char* kNames[] = {"Xposition", "Yposition", "Zposition", "Xrotation", "Yrotation", "Zrotation"};
    const std::string name = words.next();
    for (size_t i = 0; i < std::size(kNames); ++i)
        if (lower_case(name) == lower_case(kNames[i])) return static_cast<Channel>(i);
    words.fail(fmt::format("\"{}\" is no channel", name));
}

// A joint's name, which may have spaces, and the brace behind it.
std::string read_name(Words& words) {
    std::string name;
    while (true) {
        std::string word = words.next();
        if (lower_case(word) == "offset" || word == "}") words.fail(fmt::format("\"{}\" stands where {{ should", word));
        const bool ends = word.ends_with('{');
        if (ends) word.pop_back();
        if (!word.empty()) name += (name.empty() ? "" : " ") + word;
        if (ends) return name;
    }
}

BvhHierarchy read_hierarchy(Words& words) {
    BvhHierarchy hierarchy;
    words.expect("HIERARCHY");
    words.expect("ROOT");
    std::vector<int32_t> open;  // joints whose braces are open
    for (bool first = true; first || !open.empty(); first = false) {
        const std::string kind = first ? "joint" : lower_case(words.next());
        if (kind == "}") {
            open.pop_back();
        } else if (kind == "end") {  // the end of a limb, which is no joint
            read_name(words);
            read_offset(words);
            words.expect("}");
        } else if (kind == "joint") {
            if (hierarchy.joints.size() == kMaxBvhJoints) words.fail("has more than 1000 joints");
            BvhJoint joint{read_name(words), open.empty() ? -1 : open.back(), glm::dvec3(0), {}};
            joint.offset = read_offset(words);
            words.expect("CHANNELS");
            const auto count = static_cast<size_t>(words.number(0, kMaxBvhChannels));
            for (size_t i = 0; i < count; ++i) joint.channels.push_back(read_channel(words));
            hierarchy.channels += count;
            open.push_back(static_cast<int32_t>(hierarchy.joints.size()));
            hierarchy.joints.push_back(std::move(joint));
        } else {
            words.fail(fmt::format("\"{}\" stands where a joint should begin or end", kind));
        }
    }
    return hierarchy;
}

// A joint's place and turn relative to its parent. Rotations apply in the order of the channels.
glm::dmat4 local_transform(const BvhJoint& joint, const double* values) {
    glm::dvec3 place = joint.offset;
    glm::dmat4 turn(1);
    bool placed = false;
    for (size_t i = 0; i < joint.channels.size(); ++i) {
        const auto channel = static_cast<int>(joint.channels[i]);
        if (channel < 3) {
            if (!placed) place = glm::dvec3(0);  // positions stand for the offset
            placed = true;
            place[channel] = values[i];
        } else {
            glm::dvec3 axis(0);
            axis[channel - 3] = 1;
            turn = glm::rotate(turn, glm::radians(values[i]), axis);
        }
    }
    return glm::translate(glm::dmat4(1), place) * turn;
}

std::vector<glm::dmat4> world_transforms(const BvhHierarchy& hierarchy, const std::vector<double>& values) {
    std::vector<glm::dmat4> world;
    size_t at = 0;
    for (const BvhJoint& joint : hierarchy.joints) {
        const glm::dmat4 local = local_transform(joint, values.data() + at);
        world.push_back(joint.parent < 0 ? local : world[static_cast<size_t>(joint.parent)] * local);
        at += joint.channels.size();
    }
    return world;
}

std::vector<RestBone> bones_at_rest(const BvhHierarchy& hierarchy) {
    std::vector<RestBone> bones;
    for (const BvhJoint& joint : hierarchy.joints) {
        const glm::dmat4 local = glm::translate(glm::dmat4(1), joint.offset);
        const glm::dmat4 world =
            joint.parent < 0 ? local : bones[static_cast<size_t>(joint.parent)].world_from_bone * local;
        bones.push_back({joint.name, world, {}});
    }
    return bones;
}

}  // namespace

FileMotion read_bvh(const std::filesystem::path& file) {
    Words words(file);
    const BvhHierarchy hierarchy = read_hierarchy(words);
    words.expect("MOTION");
    words.expect("Frames:");
    const auto frames = static_cast<size_t>(words.number(1, static_cast<double>(kMaxSkeletonFrames)));
    words.expect("Frame");
    words.expect("Time:");
    if (hierarchy.channels == 0) words.fail("has no channels, so nothing moves", "export it with its motion");
    if (static_cast<double>(frames * hierarchy.joints.size()) > kMaxPoses)
        words.fail("has too many frames for so many joints", "export fewer joints, or cut it");
    SkeletonClip clip;
    clip.fps = 1 / words.number(1e-4, 1e3);
    // 30 frames a second are written as 0.0333333; 29.97 stay.
    if (std::abs(clip.fps - std::round(clip.fps)) < kRateRounding * clip.fps) clip.fps = std::round(clip.fps);
    const JointSources sources = joint_sources(bones_at_rest(hierarchy), file.string());
    std::vector<double> values(hierarchy.channels);
    for (size_t f = 0; f < frames; ++f) {
        for (double& value : values) value = words.number(-kMaxOffset, kMaxOffset);
        clip.frames.push_back(pose_of(sources, world_transforms(hierarchy, values)));
    }
    return {std::move(clip), 0, false};
}

}  // namespace neuvv::motion
