#include "motion/skeleton/model_motion.h"

#include <algorithm>

#include "motion/skeleton/humanoid.h"
#include "stage/pose.h"

namespace neuvv::motion {

namespace {

// Which joint of a skin moves a vertex most.
uint32_t main_joint(const stage::GltfPrimitive& primitive, size_t vertex) {
    float most = -1;
    uint32_t joint = 0;
    for (size_t set = vertex * primitive.joint_sets; set < (vertex + 1) * primitive.joint_sets; ++set)
        for (int i = 0; i < 4; ++i)
            if (primitive.weights[set][i] > most) {
                most = primitive.weights[set][i];
                joint = primitive.joints[set][i];
            }
    return joint;
}

// Puts the bones of a skin into their bind pose, each with the vertices that follow it.
void bind_skin(const stage::GltfSkin& skin, const stage::GltfMesh& mesh, std::vector<RestBone>& bones) {
    // A skin without matrices has its vertices in the spaces of their joints, and no pose but that of its nodes.
    const bool has_bind_pose =
        std::ranges::any_of(skin.inverse_binds, [](const glm::dmat4& m) { return m != glm::dmat4(1); });
    for (size_t j = 0; j < skin.joints.size() && has_bind_pose; ++j)
        if (std::abs(glm::determinant(skin.inverse_binds[j])) > 1e-12)
            bones[skin.joints[j]].world_from_bone = glm::inverse(skin.inverse_binds[j]);
    for (const stage::GltfPrimitive& primitive : mesh.primitives)
        for (size_t v = 0; v < primitive.positions.size() && !primitive.joints.empty(); ++v) {
            const uint32_t joint = main_joint(primitive, v);
            const glm::dvec3 position(primitive.positions[v]);
            RestBone& bone = bones[skin.joints[joint]];
            bone.skin.emplace_back(has_bind_pose ? position
                                                 : glm::dvec3(bone.world_from_bone * glm::dvec4(position, 1)));
        }
}

// The nodes as bones: in the bind pose where a skin has them, else where the file puts them.
std::vector<RestBone> rest_bones(const stage::GltfScene& scene) {
    const stage::PosedScene rest = stage::pose_scene(scene, stage::kNoAnimation, 0);
    std::vector<RestBone> bones(scene.nodes.size());
    // Where there are skins, only their joints are bones: a mesh may be called "head", too.
    std::vector<bool> is_bone(scene.nodes.size(), scene.skins.empty());
    for (const stage::GltfSkin& skin : scene.skins)
        for (const uint32_t joint : skin.joints) is_bone[joint] = true;
    for (size_t n = 0; n < bones.size(); ++n)
        bones[n] = {is_bone[n] ? scene.nodes[n].name : "", rest.world_from_node[n], {}};
    for (const stage::GltfNode& node : scene.nodes)
        if (node.draws_mesh() && node.skin >= 0)
            bind_skin(scene.skins[static_cast<size_t>(node.skin)], scene.meshes[static_cast<size_t>(node.mesh)], bones);
    return bones;
}

}  // namespace

SkeletonClip model_motion(const stage::GltfScene& scene, int32_t animation, const std::vector<double>& times_s,
                          double fps) {
    const JointSources sources = joint_sources(rest_bones(scene), scene.file);
    SkeletonClip clip;
    clip.fps = fps;
    for (const double time : times_s)
        clip.frames.push_back(pose_of(sources, stage::pose_scene(scene, animation, time).world_from_node));
    expect_finite(clip, scene.file);
    return clip;
}

}  // namespace neuvv::motion
