#include "stage/gltf/gltf_scene.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/platform.h"
#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_parse.h"

namespace neuvv::stage {

namespace {

// Reads a list of `length` numbers; returns false where it is missing.
bool read_list(const GltfScene& scene, const std::vector<double>& list, size_t length, double* out,
               const std::string& place) {
    if (list.empty()) return false;
    if (list.size() != length)
        throw InputError(scene.file, place, fmt::format("has {} numbers, need {}", list.size(), length));
    for (size_t i = 0; i < length; ++i) {
        // Larger numbers would overflow in products of a chain of matrices.
        if (!(std::abs(list[i]) < 1e12)) throw InputError(scene.file, place, fmt::format("{} is too large", list[i]));
        out[i] = list[i];
    }
    return true;
}

void read_transform(const GltfScene& scene, const tinygltf::Node& source, GltfNode& node, const std::string& place) {
    node.has_matrix = read_list(scene, source.matrix, 16, &node.matrix[0][0], place + "/matrix");
    read_list(scene, source.translation, 3, &node.translation[0], place + "/translation");
    read_list(scene, source.scale, 3, &node.scale[0], place + "/scale");
    double q[4];
    if (!read_list(scene, source.rotation, 4, q, place + "/rotation")) return;
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (length < 1e-6) throw InputError(scene.file, place + "/rotation", "is a quaternion of length 0");
    node.rotation = glm::dquat(q[3] / length, q[0] / length, q[1] / length, q[2] / length);
}

// Checks that every joint that a vertex of the node's mesh uses exists in the node's skin.
void check_skin(const GltfScene& scene, const GltfNode& node, const std::string& place) {
    const GltfMesh& mesh = scene.meshes[static_cast<size_t>(node.mesh)];
    const size_t joints = scene.skins[static_cast<size_t>(node.skin)].joints.size();
    for (size_t p = 0; p < mesh.primitives.size(); ++p) {
        const std::string at = fmt::format("/meshes/{}/primitives/{}/attributes", node.mesh, p);
        if (mesh.primitives[p].joints.empty())
            throw InputError(scene.file, at, fmt::format("has no JOINTS_0, but {} has a skin", place));
        if (mesh.primitives[p].joint_count > joints)
            throw InputError(scene.file, at + "/JOINTS_0",
                             fmt::format("joint {} is past the {} of skin {}", mesh.primitives[p].joint_count - 1,
                                         joints, node.skin));
    }
}

void read_visibility(const GltfScene& scene, const tinygltf::Node& source, GltfNode& node, const std::string& place) {
    const auto extension = source.extensions.find(kVisibilityExtension);
    if (extension == source.extensions.end() || !extension->second.Has("visible")) return;
    const tinygltf::Value& visible = extension->second.Get("visible");
    if (!visible.IsBool())
        throw InputError(scene.file, fmt::format("{}/extensions/{}/visible", place, kVisibilityExtension),
                         "is neither true nor false");
    node.visible = visible.Get<bool>();
}

void read_node(GltfScene& scene, const tinygltf::Node& source, size_t index) {
    const std::string place = fmt::format("/nodes/{}", index);
    GltfNode& node = scene.nodes[index];
    node.name = source.name;
    read_transform(scene, source, node, place);
    if (source.mesh >= static_cast<int>(scene.meshes.size()))
        throw InputError(scene.file, place + "/mesh", fmt::format("{} does not exist", source.mesh));
    if (source.skin >= static_cast<int>(scene.skins.size()))
        throw InputError(scene.file, place + "/skin", fmt::format("{} does not exist", source.skin));
    node.mesh = source.mesh < 0 ? -1 : source.mesh;
    if (node.mesh >= 0) {
        node.skin = source.skin < 0 ? -1 : source.skin;
        if (node.skin >= 0) check_skin(scene, node, place);
        node.weights = scene.meshes[static_cast<size_t>(node.mesh)].weights;
        if (!source.weights.empty()) {
            if (source.weights.size() != node.weights.size())
                throw InputError(
                    scene.file, place + "/weights",
                    fmt::format("has {} weights for {} morph targets", source.weights.size(), node.weights.size()));
            for (size_t i = 0; i < node.weights.size(); ++i) node.weights[i] = static_cast<float>(source.weights[i]);
        }
    }
    read_visibility(scene, source, node, place);
    for (const int child : source.children) {
        const std::string at = place + "/children";
        if (child < 0 || static_cast<size_t>(child) >= scene.nodes.size())
            throw InputError(scene.file, at, fmt::format("{} does not exist", child));
        GltfNode& below = scene.nodes[static_cast<size_t>(child)];
        if (below.parent >= 0) throw InputError(scene.file, at, fmt::format("{} has two parents", child));
        below.parent = static_cast<int32_t>(index);
        node.children.push_back(static_cast<uint32_t>(child));
    }
}

// Orders parents before children. As each node has at most one parent, only nodes in or below a cycle are left over.
void order_nodes(GltfScene& scene) {
    for (uint32_t i = 0; i < scene.nodes.size(); ++i)
        if (scene.nodes[i].parent < 0) scene.order.push_back(i);
    for (size_t next = 0; next < scene.order.size(); ++next) {
        const std::vector<uint32_t>& children = scene.nodes[scene.order[next]].children;
        scene.order.insert(scene.order.end(), children.begin(), children.end());
    }
    if (scene.order.size() == scene.nodes.size()) return;
    std::vector<bool> reached(scene.nodes.size(), false);
    for (const uint32_t i : scene.order) reached[i] = true;
    for (size_t i = 0; i < scene.nodes.size(); ++i)
        if (!reached[i]) throw InputError(scene.file, fmt::format("/nodes/{}", i), "is its own ancestor");
}

void mark_scene(GltfScene& scene, const tinygltf::Model& model) {
    if (model.scenes.empty()) {  // glTF leaves the choice to the viewer: here every node belongs to the scene
        for (GltfNode& node : scene.nodes) node.in_scene = true;
        return;
    }
    const int index = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (static_cast<size_t>(index) >= model.scenes.size())
        throw InputError(scene.file, "/scene", fmt::format("{} does not exist", index));
    scene.root = index;
    if (model.scenes.size() > 1)
        scene.notes.push_back(fmt::format("shows its scene {} alone; it has {}", index, model.scenes.size()));
    for (const int root : model.scenes[static_cast<size_t>(index)].nodes) {
        if (root < 0 || static_cast<size_t>(root) >= scene.nodes.size())
            throw InputError(scene.file, fmt::format("/scenes/{}/nodes", index),
                             fmt::format("{} does not exist", root));
        scene.nodes[static_cast<size_t>(root)].in_scene = true;
    }
    for (const uint32_t i : scene.order) {
        const int32_t parent = scene.nodes[i].parent;
        if (parent >= 0 && scene.nodes[static_cast<size_t>(parent)].in_scene) scene.nodes[i].in_scene = true;
    }
}

}  // namespace

void load_nodes(GltfScene& scene, const tinygltf::Model& model) {
    scene.nodes.resize(model.nodes.size());
    for (size_t i = 0; i < model.nodes.size(); ++i) read_node(scene, model.nodes[i], i);
    order_nodes(scene);
    for (const uint32_t i : scene.order) {
        const int32_t parent = scene.nodes[i].parent;
        if (parent >= 0 && !scene.nodes[static_cast<size_t>(parent)].visible) scene.nodes[i].visible = false;
    }
    mark_scene(scene, model);
}

void load_skins(GltfScene& scene, AccessorReader& reader) {
    std::vector<GltfSkin> skins;
    for (size_t s = 0; s < reader.model.skins.size(); ++s) {
        const tinygltf::Skin& source = reader.model.skins[s];
        const std::string place = fmt::format("/skins/{}", s);
        GltfSkin skin;
        skin.name = source.name;
        if (source.joints.empty()) throw InputError(scene.file, place + "/joints", "is empty");
        for (const int joint : source.joints) {
            if (joint < 0 || static_cast<size_t>(joint) >= reader.model.nodes.size())
                throw InputError(scene.file, place + "/joints", fmt::format("node {} does not exist", joint));
            skin.joints.push_back(static_cast<uint32_t>(joint));
        }
        skin.inverse_binds.assign(skin.joints.size(), glm::dmat4(1));
        if (source.inverseBindMatrices >= 0) {
            const std::vector<float> values =
                read_floats(reader, source.inverseBindMatrices, 16, place + "/inverseBindMatrices");
            if (values.size() < skin.joints.size() * 16)
                throw InputError(scene.file, place + "/inverseBindMatrices",
                                 fmt::format("has {} matrices for {} joints", values.size() / 16, skin.joints.size()));
            for (size_t i = 0; i < skin.joints.size() * 16; ++i)
                skin.inverse_binds[i / 16][static_cast<int>(i % 16 / 4)][static_cast<int>(i % 4)] =
                    static_cast<double>(values[i]);
        }
        skins.push_back(std::move(skin));
    }
    scene.skins = std::move(skins);
}

namespace {

bool fits_nodes(const GltfScene& scene) {
    for (const GltfSkin& skin : scene.skins)
        for (const uint32_t joint : skin.joints)
            if (joint >= scene.nodes.size()) return false;
    for (const GltfAnimation& animation : scene.animations)
        for (const GltfChannel& channel : animation.channels) {
            if (channel.node >= scene.nodes.size()) return false;
            const GltfNode& node = scene.nodes[channel.node];
            const bool weights = channel.path == GltfPath::kWeights;
            if (weights ? node.weights.size() != channel.components : node.has_matrix) return false;
        }
    return true;
}

}  // namespace

GltfScene load_gltf(const std::filesystem::path& path) {
    return load_gltf(path, read_file(path, kMaxStageBytes));
}

GltfScene load_gltf(const std::filesystem::path& path, std::vector<uint8_t> bytes, const GltfScene* before) {
    GltfScene scene;
    scene.file = path.string();
    const auto [model, notes] = parse_gltf(path, std::move(bytes));
    scene.notes = notes;
    AccessorReader reader{scene.file, model};
    const std::vector<MaterialTransforms> transforms = load_materials(scene, model);
    load_meshes(scene, reader, transforms);
    load_skins(scene, reader);
    load_nodes(scene, model);
    load_animations(scene, reader);
    load_cameras(scene, model);
    load_lights(scene, model);
    load_images(scene, model, before);  // last, because it is expensive
    return scene;
}

std::optional<GltfScene> load_gltf_nodes(const std::filesystem::path& path, std::vector<uint8_t> bytes,
                                         const GltfScene& before) {
    GltfScene scene;
    scene.file = path.string();
    scene.meshes = before.meshes;
    scene.materials = before.materials;
    scene.textures = before.textures;
    scene.images = before.images;
    scene.skins = before.skins;
    scene.animations = before.animations;
    const tinygltf::Model model = parse_gltf(path, std::move(bytes)).model;
    load_nodes(scene, model);
    scene.notes = before.notes;
    if (!fits_nodes(scene)) return std::nullopt;
    load_cameras(scene, model);
    load_lights(scene, model);
    return scene;
}

uint32_t find_animation(const GltfScene& scene, const std::string& name_or_index) {
    for (size_t i = 0; i < scene.animations.size(); ++i)
        if (scene.animations[i].name == name_or_index) return static_cast<uint32_t>(i);
    uint32_t index = 0;
    const char* end = name_or_index.data() + name_or_index.size();
    const auto [stop, error] = std::from_chars(name_or_index.data(), end, index);
    if (error == std::errc() && stop == end && index < scene.animations.size()) return index;
    std::string names;
    for (size_t i = 0; i < scene.animations.size(); ++i)
        names += fmt::format("{}{} \"{}\"", i ? ", " : "", i, scene.animations[i].name);
    throw InputError(scene.file, "/animations", fmt::format("no animation \"{}\"", name_or_index),
                     names.empty() ? "the model has none" : "choose from " + names);
}

}  // namespace neuvv::stage
