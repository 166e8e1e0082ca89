// Reading skeletons: of this program, and of animated glTF models.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/platform.h"
#include "base/text.h"
#include "motion/skeleton/model_motion.h"
#include "motion/skeleton/skeleton_file.h"
#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/pose.h"

namespace neuvv::motion {

namespace {

using nlohmann::ordered_json;

// The nodes of the joints, by their names. Throws InputError for the first that is missing.
std::array<size_t, kJoints> joint_nodes(const stage::GltfScene& scene) {
    std::array<size_t, kJoints> nodes{};
    for (size_t j = 0; j < kJoints; ++j) {
        const char* name = info_of(joint_at(j)).name;
        const auto found = std::ranges::find(scene.nodes, name, &stage::GltfNode::name);
        if (found == scene.nodes.end())
            throw InputError(scene.file, "/nodes", fmt::format("has no joint \"{}\"", name),
                             Remedy::kWriteSkeletonAgain);
        nodes[j] = static_cast<size_t>(found - scene.nodes.begin());
    }
    return nodes;
}

// Confidence and origin of each joint of a frame.
void read_frame(const OrderedJsonNode& confidence, const OrderedJsonNode& measured, Pose& pose) {
    expect_array(confidence, kJoints);
    const uint64_t mask = json_count(measured, (uint64_t{1} << kJoints) - 1);
    for (size_t j = 0; j < kJoints; ++j) {
        pose[j].confidence = json_number(confidence[j], 0, 100, "a percentage") / 100;
        pose[j].measured = mask >> j & 1;
    }
}

SkeletonClip own_skeleton(const stage::GltfScene& scene, const ordered_json& extension) {
    const OrderedJsonNode root{extension, scene.file, "extensions." + std::string(kSkeletonExtension)};
    if (json_count(root["version"], 1000) != 1)
        root["version"].fail("is a version that this program does not know", "update NeuVV");
    SkeletonClip clip;
    clip.fps = json_number(root["fps"], 1e-3, 1e4, "a number of frames a second");
    const OrderedJsonNode confidence = root["confidence"], measured = root["measured"];
    expect_list(confidence);
    if (confidence.value.size() > kMaxSkeletonFrames)
        confidence.fail(fmt::format("has more than {} frames", kMaxSkeletonFrames));
    expect_array(measured, confidence.value.size());
    if (scene.animations.empty()) throw InputError(scene.file, "/animations", "has no animation");
    const std::array<size_t, kJoints> nodes = joint_nodes(scene);
    clip.frames.resize(confidence.value.size());
    for (size_t f = 0; f < clip.frames.size(); ++f) {
        read_frame(confidence[f], measured[f], clip.frames[f]);
        const stage::PosedScene pose = stage::pose_scene(scene, 0, static_cast<double>(f) / clip.fps);
        for (size_t j = 0; j < kJoints; ++j) clip.frames[f][j].position = pose.world_from_node[nodes[j]][3];
    }
    return clip;
}

// How many keys a second the channel with the most keys has, within what motion capture uses.
double rate_of(const stage::GltfAnimation& animation) {
    size_t keys = 0;
    for (const stage::GltfChannel& channel : animation.channels) keys = std::max(keys, channel.times.size());
    if (keys < 2 || !(animation.duration_s > 0)) return 30;
    return std::clamp(std::round(static_cast<double>(keys - 1) / animation.duration_s), 10.0, 240.0);
}

SkeletonClip animated_model(const stage::GltfScene& scene, const std::string& name) {
    if (scene.animations.empty())
        throw InputError(scene.file, "/animations", "has no animation", "export the model with its motion");
    const uint32_t index = name.empty() ? 0 : stage::find_animation(scene, name);
    const stage::GltfAnimation& animation = scene.animations[index];
    const double fps = rate_of(animation);
    const double last = std::floor(animation.duration_s * fps + 1e-6);
    if (!(last < static_cast<double>(kMaxSkeletonFrames)))
        throw InputError(scene.file, fmt::format("/animations/{}", index),
                         fmt::format("has more than {} frames", kMaxSkeletonFrames));
    std::vector<double> times;
    for (double f = 0; f <= last; ++f) times.push_back(f / fps);
    return model_motion(scene, static_cast<int32_t>(index), times, fps);
}

// Calls the nodes as a VRM's extension does: {"hips": {"node": 3}} of VRM 1.0 and of VRM animations, [{"bone": "hips",
// "node": 3}] of VRM 0. The nodes' own names may be of any language.
void name_vrm_bones(const ordered_json& extensions, stage::GltfScene& scene) {
    for (const char* name : {"VRMC_vrm", "VRMC_vrm_animation", "VRM"}) {
        const ordered_json bones =
            extensions.value(ordered_json::json_pointer(fmt::format("/{}/humanoid/humanBones", name)), ordered_json());
        for (const auto& [key, bone] : bones.items()) {
            if (!bone.is_object() || !bone.contains("node") || !bone["node"].is_number_unsigned()) continue;
            const std::string vrm =
                bone.contains("bone") && bone["bone"].is_string() ? bone["bone"].get<std::string>() : key;
            const size_t node = bone["node"];
            if (node < scene.nodes.size()) scene.nodes[node].name = vrm;
        }
    }
}

FileMotion read_gltf_skeleton(const std::filesystem::path& file, const std::string& animation) {
    const stage::StageFile document = stage::read_stage_file(file);
    stage::GltfScene scene = stage::load_gltf(file);
    const ordered_json extensions = document.json.value("extensions", ordered_json::object());
    if (extensions.is_object() && extensions.contains(kSkeletonExtension))
        return {own_skeleton(scene, extensions[kSkeletonExtension]), 1, true};
    if (extensions.is_object()) name_vrm_bones(extensions, scene);
    return {animated_model(scene, animation), 1, true};
}

FileMotion read_by_ending(const std::filesystem::path& file, const std::string& animation) {
    const std::string ending = lower_case(file.extension().string());
    if (ending == ".bvh") return read_bvh(file);
    if (ending == ".trc") return read_trc(file);
    if (ending == ".glb" || ending == ".gltf" || ending == ".vrm" || ending == ".vrma")
        return read_gltf_skeleton(file, animation);
    throw InputError(file.string(), "", "is no skeleton that this program knows",
                     "give a .glb, .gltf, .vrm, .vrma, .bvh or .trc");
}

}  // namespace

SkeletonClip read_skeleton(const std::filesystem::path& file, const SkeletonReading& reading) {
    FileMotion motion = read_by_ending(file, reading.animation);
    bring_to_metres({reading.up, motion.y_is_up, reading.unit_m > 0 ? reading.unit_m : motion.unit_m, reading.height_m},
                    file.string(), motion.clip);
    expect_finite(motion.clip, file.string());
    return std::move(motion.clip);
}

std::filesystem::path skeleton_beside(const std::filesystem::path& video) {
    return std::filesystem::path(video).replace_extension(".skeleton.glb");
}

}  // namespace neuvv::motion
