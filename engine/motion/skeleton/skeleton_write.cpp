// Writing a skeleton as a .glb.
#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "motion/skeleton/bone_motion.h"
#include "motion/skeleton/skeleton_file.h"
#include "stage/gltf/glb_writer.h"

namespace neuvv::motion {

namespace {

using nlohmann::ordered_json;

std::vector<float> list_of(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

// An octahedron for each bone, thick near its parent. All of it follows the parent's joint but for the tip.
ordered_json bone_mesh(stage::GlbWriter& glb, const Positions& rest) {
    std::vector<glm::vec3> positions;
    std::vector<uint16_t> joints, indices;
    std::vector<float> weights;
    for (size_t j = 1; j < kJoints; ++j) {
        const auto parent = static_cast<uint16_t>(index_of(info_of(joint_at(j)).parent));
        const glm::dvec3 from = rest[parent], to = rest[j], along = to - from;
        const glm::dvec3 other =
            std::abs(along.x) > 0.9 * glm::length(along) ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
        const glm::dvec3 side = glm::length(along) > 1e-9 ? glm::normalize(glm::cross(along, other)) : glm::dvec3(0);
        const glm::dvec3 third = glm::length(along) > 1e-9 ? glm::cross(glm::normalize(along), side) : glm::dvec3(0);
        const double thick = 0.1 * glm::length(along);
        const auto base = static_cast<uint16_t>(positions.size());
        positions.emplace_back(from);
        for (const glm::dvec3& around : {side, third, -side, -third})
            positions.emplace_back(from + 0.2 * along + thick * around);
        positions.emplace_back(to);
        for (uint16_t v = 0; v < 6; ++v) {
            joints.insert(joints.end(), {v == 5 ? static_cast<uint16_t>(j) : parent, 0, 0, 0});
            weights.insert(weights.end(), {1, 0, 0, 0});
        }
        for (uint16_t k = 0; k < 4; ++k) {
            const auto a = static_cast<uint16_t>(base + 1 + k), b = static_cast<uint16_t>(base + 1 + (k + 1) % 4);
            indices.insert(indices.end(), {base, b, a, static_cast<uint16_t>(base + 5), a, b});
        }
    }
    const size_t position = glb.add_positions(positions);
    const size_t joint = glb.add(joints, "VEC4", 4, stage::kGltfUnsignedShort),
                 weight = glb.add(weights, "VEC4", 4, stage::kGltfFloat);
    return {{"name", "bones"},
            {"primitives",
             {{{"attributes", {{"POSITION", position}, {"JOINTS_0", joint}, {"WEIGHTS_0", weight}}},
               {"indices", glb.add(indices, "SCALAR", 1, stage::kGltfUnsignedShort)},
               {"material", 0}}}}};
}

// A node for each joint, and one for the mesh.
ordered_json nodes_of(const Positions& rest) {
    ordered_json nodes = ordered_json::array();
    for (size_t j = 0; j < kJoints; ++j) {
        const size_t parent = index_of(info_of(joint_at(j)).parent);
        const glm::vec3 place = j == 0 ? rest[0] : rest[j] - rest[parent];
        nodes.push_back({{"name", info_of(joint_at(j)).name}, {"translation", list_of(place)}});
        if (j > 0) nodes[parent]["children"].push_back(j);
    }
    nodes.push_back({{"name", "bones"}, {"mesh", 0}, {"skin", 0}});
    return nodes;
}

ordered_json skin_of(stage::GlbWriter& glb, const Positions& rest) {
    std::vector<float> inverse_binds;
    ordered_json joints = ordered_json::array();
    for (size_t j = 0; j < kJoints; ++j) {
        const glm::vec3 p = -rest[j];
        inverse_binds.insert(inverse_binds.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, p.x, p.y, p.z, 1});
        joints.push_back(j);
    }
    return {{"joints", joints},
            {"skeleton", 0},
            {"inverseBindMatrices", glb.add(inverse_binds, "MAT4", 16, stage::kGltfFloat)}};
}

ordered_json animation_of(stage::GlbWriter& glb, const std::vector<Positions>& frames, double fps) {
    std::vector<float> times;
    std::array<std::vector<glm::vec3>, kJoints> places;
    std::array<std::vector<float>, kJoints> turns;
    for (size_t f = 0; f < frames.size(); ++f) {
        times.push_back(static_cast<float>(static_cast<double>(f) / fps));
        const std::array<BoneTransform, kJoints> bones = bone_transforms(frames[0], frames[f]);
        for (size_t j = 0; j < kJoints; ++j) {
            places[j].emplace_back(bones[j].translation);
            const glm::quat turn(bones[j].rotation);
            turns[j].insert(turns[j].end(), {turn.x, turn.y, turn.z, turn.w});
        }
    }
    const size_t time = glb.add_times(times);
    ordered_json animation = {
        {"name", "motion"}, {"samplers", ordered_json::array()}, {"channels", ordered_json::array()}};
    for (size_t j = 0; j < kJoints; ++j) {
        stage::add_gltf_channel(animation, time, glb.add_vectors(places[j]), j, "translation");
        stage::add_gltf_channel(animation, time, glb.add(turns[j], "VEC4", 4, stage::kGltfFloat), j, "rotation");
    }
    return animation;
}

ordered_json extension_of(const SkeletonClip& clip) {
    ordered_json confidence = ordered_json::array(), measured = ordered_json::array();
    for (const Pose& pose : clip.frames) {
        ordered_json percents = ordered_json::array();
        uint32_t mask = 0;
        for (size_t j = 0; j < kJoints; ++j) {
            // What is known at all stays known.
            const double percent = 100 * std::min(pose[j].confidence, 1.0);
            percents.push_back(percent > 0 ? std::max(1L, std::lround(percent)) : 0L);
            mask |= static_cast<uint32_t>(pose[j].measured) << j;
        }
        confidence.push_back(std::move(percents));
        measured.push_back(mask);
    }
    return {{"version", 1}, {"fps", clip.fps}, {"measured", measured}, {"confidence", confidence}};
}

}  // namespace

void write_skeleton(const std::filesystem::path& file, const SkeletonClip& clip) {
    assert(!clip.frames.empty());
    if (clip.frames.size() > kMaxSkeletonFrames)
        throw InputError(file.string(), "", fmt::format("would have more than {} frames", kMaxSkeletonFrames),
                         "cut the clip");
    const std::vector<Positions> frames = filled_positions(clip);
    stage::GlbWriter glb;
    glb.json["scene"] = 0;
    glb.json["scenes"] = {{{"nodes", {0, kJoints}}}};
    glb.json["nodes"] = nodes_of(frames[0]);
    glb.json["meshes"] = {bone_mesh(glb, frames[0])};
    glb.json["materials"] = {
        {{"name", "bone"},
         {"pbrMetallicRoughness", {{"baseColorFactor", {0.85, 0.85, 0.8, 1}}, {"metallicFactor", 0}}}}};
    glb.json["skins"] = {skin_of(glb, frames[0])};
    glb.json["animations"] = {animation_of(glb, frames, clip.fps)};
    glb.json["extensionsUsed"] = {kSkeletonExtension};
    glb.json["extensions"] = {{kSkeletonExtension, extension_of(clip)}};
    glb.write(file, "cut the clip");
}

}  // namespace neuvv::motion
