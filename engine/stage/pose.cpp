#include "stage/pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace neuvv::stage {

namespace {

// Where a time lies between keys.
struct KeySpan {
    size_t key = 0;       // the last key at or before the time; the first key for times before it
    double share = 0;     // the time, from 0 at this key to 1 at the next; 0 outside of all keys
    double length_s = 0;  // from this key to the next
};

KeySpan find_span(const std::vector<float>& times, double t) {
    if (t <= static_cast<double>(times.front())) return {};
    if (t >= static_cast<double>(times.back())) return {times.size() - 1, 0, 0};
    const auto after = std::upper_bound(times.begin(), times.end(), t,
                                        [](double value, float time) { return value < static_cast<double>(time); });
    const auto key = static_cast<size_t>(after - times.begin()) - 1;
    const auto start = static_cast<double>(times[key]);
    const double length = static_cast<double>(times[key + 1]) - start;
    return {key, (t - start) / length, length};
}

glm::dquat quaternion(const double* xyzw) {
    const glm::dquat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    const double length = glm::length(q);
    return length > 1e-12 ? q / length : glm::dquat(1, 0, 0, 0);
}

// glTF 2.0, appendix C: a cubic Hermite spline; tangents are per second.
void sample_cubic(const GltfChannel& channel, const KeySpan& span, std::vector<double>& out) {
    const size_t n = channel.components;
    const float* here = &channel.values[span.key * 3 * n];
    const float* next = span.share > 0 ? here + 3 * n : here;
    const double s = span.share, s2 = s * s, s3 = s2 * s;
    for (size_t c = 0; c < n; ++c) {
        const auto value = [&](const float* key, size_t part) { return static_cast<double>(key[part * n + c]); };
        out[c] = (2 * s3 - 3 * s2 + 1) * value(here, 1) + span.length_s * (s3 - 2 * s2 + s) * value(here, 2) +
                 (-2 * s3 + 3 * s2) * value(next, 1) + span.length_s * (s3 - s2) * value(next, 0);
    }
}

void sample(const GltfChannel& channel, double t, std::vector<double>& out) {
    const size_t n = channel.components;
    out.assign(n, 0.0);
    const KeySpan span = find_span(channel.times, t);
    if (channel.interpolation == GltfInterpolation::kCubicSpline) return sample_cubic(channel, span, out);
    const float* here = &channel.values[span.key * n];
    out.assign(here, here + n);
    if (channel.interpolation == GltfInterpolation::kStep || span.share <= 0) return;
    const std::vector<double> next(here + n, here + 2 * n);
    if (channel.path == GltfPath::kRotation) {
        const glm::dquat q = glm::slerp(quaternion(out.data()), quaternion(next.data()), span.share);
        out = {q.x, q.y, q.z, q.w};
    } else {
        for (size_t c = 0; c < n; ++c) out[c] += (next[c] - out[c]) * span.share;
    }
}

struct LocalTransform {
    glm::dvec3 translation;
    glm::dquat rotation;
    glm::dvec3 scale;
};

glm::dmat4 matrix_of(const LocalTransform& local) {
    glm::dmat4 matrix = glm::mat4_cast(local.rotation);
    for (int axis = 0; axis < 3; ++axis) matrix[axis] *= local.scale[axis];
    matrix[3] = glm::dvec4(local.translation, 1);
    return matrix;
}

void animate(const GltfAnimation& animation, double t, std::vector<LocalTransform>& locals, PosedScene& pose) {
    std::vector<double> value;
    for (const GltfChannel& channel : animation.channels) {
        sample(channel, t, value);
        LocalTransform& local = locals[channel.node];
        switch (channel.path) {
            case GltfPath::kTranslation:
                local.translation = {value[0], value[1], value[2]};
                break;
            case GltfPath::kRotation:
                local.rotation = quaternion(value.data());
                break;
            case GltfPath::kScale:
                local.scale = {value[0], value[1], value[2]};
                break;
            case GltfPath::kWeights:
                for (size_t i = 0; i < value.size(); ++i)
                    pose.morph_weights[channel.node][i] = static_cast<float>(value[i]);
                break;
        }
    }
}

// Normals are transformed by the inverse transpose; its cofactor form also works for singular matrices.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

// Tangents are transformed as directions between positions; a matrix that mirrors flips the side of the bitangent (w).
glm::vec4 turned(const glm::vec4& tangent, const glm::dmat3& m) {
    const glm::dvec3 along = m * glm::dvec3(tangent);
    const double length = glm::length(along);
    if (!(length > 0 && std::isfinite(length))) return tangent;
    return {glm::vec3(along / length), glm::determinant(m) < 0 ? -tangent.w : tangent.w};
}

}  // namespace

PosedScene pose_scene(const GltfScene& scene, int32_t animation, double time_s) {
    PosedScene pose;
    std::vector<LocalTransform> locals;
    for (const GltfNode& node : scene.nodes) {
        locals.push_back({node.translation, node.rotation, node.scale});
        pose.morph_weights.push_back(node.weights);
    }
    if (animation == kAllAnimations)
        for (const GltfAnimation& each : scene.animations) animate(each, time_s, locals, pose);
    else if (animation != kNoAnimation)
        animate(scene.animations.at(static_cast<size_t>(animation)), time_s, locals, pose);

    pose.world_from_node.resize(scene.nodes.size());
    for (const uint32_t i : scene.order) {
        const GltfNode& node = scene.nodes[i];
        const glm::dmat4 local = node.has_matrix ? node.matrix : matrix_of(locals[i]);
        pose.world_from_node[i] =
            node.parent < 0 ? local : pose.world_from_node[static_cast<size_t>(node.parent)] * local;
    }
    for (const GltfSkin& skin : scene.skins) {
        std::vector<glm::dmat4> matrices(skin.joints.size());
        for (size_t j = 0; j < matrices.size(); ++j)
            matrices[j] = pose.world_from_node[skin.joints[j]] * skin.inverse_binds[j];
        pose.joint_matrices.push_back(std::move(matrices));
    }
    return pose;
}

void pose_vertices(const GltfScene& scene, const PosedScene& pose, uint32_t node, const GltfPrimitive& primitive,
                   PosedVertices& out) {
    const int32_t skin = scene.nodes[node].skin;
    const glm::dmat4& rigid = pose.world_from_node[node];
    const glm::dmat3 rigid_normals = normal_matrix(glm::dmat3(rigid));
    const std::vector<float>& weights = pose.morph_weights[node];
    out.positions.resize(primitive.positions.size());
    out.normals.resize(primitive.positions.size());
    out.tangents.resize(primitive.tangents.size());
    out.mirrored = skin < 0 && glm::determinant(glm::dmat3(rigid)) < 0;
    for (size_t v = 0; v < primitive.positions.size(); ++v) {
        glm::dvec3 position = primitive.positions[v], normal = primitive.normals[v];
        for (size_t t = 0; t < primitive.targets.size(); ++t) {
            const auto weight = static_cast<double>(weights[t]);
            if (weight == 0) continue;
            position += weight * glm::dvec3(primitive.targets[t].positions[v]);
            if (!primitive.targets[t].normals.empty()) normal += weight * glm::dvec3(primitive.targets[t].normals[v]);
        }
        if (skin >= 0) {
            // The node's own transform does not count for skinned meshes (glTF 2.0, 3.7.3.3).
            const std::vector<glm::dmat4>& joints = pose.joint_matrices[static_cast<size_t>(skin)];
            glm::dmat4 blend(0);
            for (size_t set = v * primitive.joint_sets; set < (v + 1) * primitive.joint_sets; ++set)
                for (int k = 0; k < 4; ++k)
                    if (primitive.weights[set][k] > 0)
                        blend += static_cast<double>(primitive.weights[set][k]) * joints[primitive.joints[set][k]];
            position = glm::dvec3(blend * glm::dvec4(position, 1));
            normal = normal_matrix(glm::dmat3(blend)) * normal;
            if (!out.tangents.empty()) out.tangents[v] = turned(primitive.tangents[v], glm::dmat3(blend));
        } else {
            position = glm::dvec3(rigid * glm::dvec4(position, 1));
            normal = rigid_normals * normal;
            if (!out.tangents.empty()) out.tangents[v] = turned(primitive.tangents[v], glm::dmat3(rigid));
        }
        const double length = glm::length(normal);
        out.positions[v] = glm::vec3(position);
        out.normals[v] = length > 0 && std::isfinite(length) ? glm::vec3(normal / length) : glm::vec3(0, 1, 0);
    }
}

std::pair<glm::dvec3, glm::dvec3> bounds_over(const GltfScene& scene, int32_t animation,
                                              const std::vector<double>& times_s) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    PosedVertices vertices;
    for (const double t : times_s) {
        const PosedScene pose = pose_scene(scene, animation, t);
        for (uint32_t n = 0; n < scene.nodes.size(); ++n) {
            if (!scene.nodes[n].draws_mesh()) continue;
            for (const GltfPrimitive& primitive : scene.meshes[static_cast<size_t>(scene.nodes[n].mesh)].primitives) {
                pose_vertices(scene, pose, n, primitive, vertices);
                for (const uint32_t index : primitive.indices) {
                    const glm::dvec3 position = vertices.positions[index];
                    if (!(std::abs(position.x) + std::abs(position.y) + std::abs(position.z) < 1e30))
                        throw InputError(scene.file, fmt::format("/nodes/{}", n),
                                         fmt::format("a vertex is not at a finite place {} s into the animation", t));
                    low = glm::min(low, position);
                    high = glm::max(high, position);
                }
            }
        }
    }
    if (low.x > high.x) throw InputError(scene.file, "/scenes", "draws no triangle");
    return {low, high};
}

}  // namespace neuvv::stage
