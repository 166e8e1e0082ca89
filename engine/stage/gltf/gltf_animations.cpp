#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "stage/gltf/gltf_parse.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

namespace {

GltfPath path_of(const GltfScene& scene, const std::string& name, const std::string& place) {
    if (name == "translation") return GltfPath::kTranslation;
    if (name == "rotation") return GltfPath::kRotation;
    if (name == "scale") return GltfPath::kScale;
    if (name == "weights") return GltfPath::kWeights;
    throw InputError(scene.file, place + "/target/path", "is not translation, rotation, scale or weights");
}

GltfInterpolation interpolation_of(const GltfScene& scene, const std::string& name, const std::string& place) {
    if (name == "LINEAR") return GltfInterpolation::kLinear;
    if (name == "STEP") return GltfInterpolation::kStep;
    if (name == "CUBICSPLINE") return GltfInterpolation::kCubicSpline;
    throw InputError(scene.file, place + "/interpolation", "is not LINEAR, STEP or CUBICSPLINE");
}

uint32_t components_of(const GltfScene& scene, const GltfChannel& channel, const std::string& place) {
    const GltfNode& node = scene.nodes[channel.node];
    if (channel.path == GltfPath::kWeights) {
        if (node.weights.empty())
            throw InputError(scene.file, place + "/target", fmt::format("node {} has no morph targets", channel.node));
        return static_cast<uint32_t>(node.weights.size());
    }
    if (node.has_matrix)
        throw InputError(scene.file, place + "/target",
                         fmt::format("node {} is animated but has a matrix", channel.node),
                         "export translation, rotation and scale");
    return channel.path == GltfPath::kRotation ? 4 : 3;
}

void check_times(const GltfScene& scene, const std::vector<float>& times, const std::string& place) {
    for (size_t i = 0; i < times.size(); ++i)
        if (times[i] < 0 || (i > 0 && times[i] <= times[i - 1]))
            throw InputError(scene.file, place + "/input",
                             fmt::format("key {} is at {} s: times must ascend from 0", i, times[i]));
}

void check_rotations(const GltfScene& scene, const GltfChannel& channel, const std::string& place) {
    const bool cubic = channel.interpolation == GltfInterpolation::kCubicSpline;
    for (size_t key = 0; key < channel.times.size(); ++key) {
        const float* q = &channel.values[(cubic ? key * 3 + 1 : key) * 4];
        if (std::abs(q[0]) + std::abs(q[1]) + std::abs(q[2]) + std::abs(q[3]) < 1e-6f)
            throw InputError(scene.file, place + "/output", fmt::format("key {} is a quaternion of length 0", key));
    }
}

GltfChannel channel_of(const GltfScene& scene, AccessorReader& reader, const tinygltf::Animation& animation,
                       const tinygltf::AnimationChannel& source, const std::string& animation_place, size_t index) {
    const std::string place = fmt::format("{}/channels/{}", animation_place, index);
    if (source.sampler < 0 || static_cast<size_t>(source.sampler) >= animation.samplers.size())
        throw InputError(scene.file, place + "/sampler", fmt::format("{} does not exist", source.sampler));
    if (static_cast<size_t>(source.target_node) >= scene.nodes.size())
        throw InputError(scene.file, place + "/target/node", fmt::format("{} does not exist", source.target_node));
    const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>(source.sampler)];
    const std::string sampler_place = fmt::format("{}/samplers/{}", animation_place, source.sampler);

    GltfChannel channel;
    channel.node = static_cast<uint32_t>(source.target_node);
    channel.path = path_of(scene, source.target_path, place);
    channel.interpolation = interpolation_of(scene, sampler.interpolation, sampler_place);
    channel.components = components_of(scene, channel, place);
    channel.times = read_floats(reader, sampler.input, 1, sampler_place + "/input");
    check_times(scene, channel.times, sampler_place);

    const bool weights = channel.path == GltfPath::kWeights;  // stored as scalars
    channel.values = read_floats(reader, sampler.output, weights ? 1 : static_cast<int>(channel.components),
                                 sampler_place + "/output");
    const size_t triple = channel.interpolation == GltfInterpolation::kCubicSpline ? 3 : 1;
    const size_t need = channel.times.size() * channel.components * triple;
    if (channel.values.size() != need)
        throw InputError(
            scene.file, sampler_place + "/output",
            fmt::format("has {} numbers, {} keys need {}", channel.values.size(), channel.times.size(), need));
    for (const float value : channel.values)
        if (std::abs(value) > 1e12f)
            throw InputError(scene.file, sampler_place + "/output", fmt::format("{} is too large", value));
    if (channel.path == GltfPath::kRotation) check_rotations(scene, channel, sampler_place);
    return channel;
}

}  // namespace

void load_animations(GltfScene& scene, AccessorReader& reader) {
    std::vector<GltfAnimation> animations;
    for (size_t a = 0; a < reader.model.animations.size(); ++a) {
        const tinygltf::Animation& source = reader.model.animations[a];
        GltfAnimation animation;
        animation.name = source.name;
        const std::string place = fmt::format("/animations/{}", a);
        for (size_t c = 0; c < source.channels.size(); ++c) {
            animation.channels.push_back(channel_of(scene, reader, source, source.channels[c], place, c));
            animation.duration_s =
                std::max(animation.duration_s, static_cast<double>(animation.channels.back().times.back()));
        }
        animations.push_back(std::move(animation));
    }
    scene.animations = std::move(animations);
}

}  // namespace neuvv::stage
