// Nodes: finding and naming them, their children, their transforms.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/error.h"
#include "edit/document.h"
#include "edit/read.h"

namespace neuvv::edit {

namespace {

// The list owner[name] of indices; empty where it is missing.
std::vector<uint32_t> indices_in(const ordered_json& owner, const char* name) {
    std::vector<uint32_t> indices;
    if (const ordered_json* list = find_member(owner, name))
        for (const ordered_json& index : *list) indices.push_back(index.get<uint32_t>());
    return indices;
}

NodeTransform parts_of(const glm::dmat4& matrix) {
    const glm::dmat3 axes(matrix);
    NodeTransform parts;
    parts.translation = matrix[3];
    parts.scale = {glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])};
    if (glm::determinant(axes) < 0) parts.scale.x = -parts.scale.x;
    glm::dmat3 rotation;
    rotation[0] = axes[0] / parts.scale.x;
    rotation[1] = glm::normalize(axes[1] - glm::dot(axes[1], rotation[0]) * rotation[0]);
    rotation[2] = glm::cross(rotation[0], rotation[1]);
    // A flat matrix gives no finite rotation.
    if (std::isfinite(glm::determinant(rotation))) parts.rotation = glm::normalize(glm::quat_cast(rotation));
    return parts;
}

}  // namespace

size_t node_count(const stage::StageFile& file) {
    const ordered_json* nodes = find_member(file.json, "nodes");
    return nodes ? nodes->size() : 0;
}

uint32_t find_node(const stage::StageFile& file, const std::string& name_or_index) {
    const auto joined = [](const std::vector<std::string>& parts) { return fmt::format("{}", fmt::join(parts, ", ")); };
    const size_t count = node_count(file);
    std::vector<std::string> found, all;
    uint32_t index = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const std::string name = name_of(file, i);
        all.push_back(fmt::format("{} \"{}\"", i, name));
        if (name != name_or_index) continue;
        found.push_back(std::to_string(i));
        index = i;
    }
    if (found.size() > 1)
        throw InputError(file.path.string(), "/nodes",
                         fmt::format("{} nodes are named \"{}\"", found.size(), name_or_index),
                         "choose by index: " + joined(found));
    if (found.size() == 1) return index;
    const char* end = name_or_index.data() + name_or_index.size();
    const auto [stop, error] = std::from_chars(name_or_index.data(), end, index);
    if (error == std::errc() && stop == end && index < count) return index;
    throw InputError(file.path.string(), "/nodes", fmt::format("there is no node \"{}\"", name_or_index),
                     all.empty() ? "the stage has none" : "choose from " + joined(all));
}

std::string name_of(const stage::StageFile& file, uint32_t node) {
    const ordered_json* name = find_member(node_of(file, node), "name");
    return name && name->is_string() ? name->get<std::string>() : "";
}

std::string node_title(const stage::StageFile& file, uint32_t node) {
    const std::string name = name_of(file, node);
    return name.empty() ? fmt::format("node {}", node) : name;
}

NodeKind kind_of(const stage::StageFile& file, uint32_t node) {
    const ordered_json& json = node_of(file, node);
    if (find_extension(json, stage::kPerformerExtension)) return NodeKind::kPerformer;
    if (find_extension(json, kLightsExtension)) return NodeKind::kLight;
    if (find_member(json, "camera")) return NodeKind::kCamera;
    if (find_member(json, "mesh")) return NodeKind::kMesh;
    return NodeKind::kGroup;
}

std::vector<uint32_t> children_of(const stage::StageFile& file, uint32_t node) {
    return indices_in(node_of(file, node), "children");
}

std::vector<uint32_t> family_of(const stage::StageFile& file, uint32_t node) {
    std::vector<uint32_t> family = {node};
    for (size_t next = 0; next < family.size(); ++next)
        for (const uint32_t child : children_of(file, family[next])) family.push_back(child);
    return family;
}

std::vector<uint32_t> scene_roots(const stage::StageFile& file) {
    if (const ordered_json* scene = find_scene(file)) return indices_in(*scene, "nodes");
    const size_t count = node_count(file);
    std::vector<bool> hangs(count);
    for (uint32_t node = 0; node < count; ++node)
        for (const uint32_t child : children_of(file, node)) hangs.at(child) = true;
    std::vector<uint32_t> roots;
    for (uint32_t node = 0; node < count; ++node)
        if (!hangs[node]) roots.push_back(node);
    return roots;
}

std::vector<bool> nodes_in_scene(const stage::StageFile& file) {
    std::vector<bool> reached(node_count(file));
    std::vector<uint32_t> waiting = scene_roots(file);
    while (!waiting.empty()) {
        const uint32_t node = waiting.back();
        waiting.pop_back();
        if (reached.at(node)) continue;
        reached[node] = true;
        for (const uint32_t child : children_of(file, node)) waiting.push_back(child);
    }
    return reached;
}

bool same_nodes(const stage::StageFile& a, const stage::StageFile& b, size_t count) {
    if (count > node_count(a) || count > node_count(b)) return false;
    for (uint32_t node = 0; node < count; ++node)
        if (node_of(a, node) != node_of(b, node)) return false;
    return true;
}

NodeTransform transform_of(const stage::StageFile& file, uint32_t node) {
    const LocalTransform transform = local_transform_of(node_of(file, node));
    if (transform.has_matrix) return parts_of(transform.matrix);
    return {transform.translation, transform.rotation, transform.scale};
}

bool is_animated(const stage::StageFile& file, uint32_t node) {
    const ordered_json* animations = find_member(file.json, "animations");
    if (!animations) return false;
    for (const ordered_json& animation : *animations) {
        const ordered_json* channels = find_member(animation, "channels");
        if (!channels) continue;
        for (const ordered_json& channel : *channels) {
            const ordered_json* target = find_member(channel, "target");
            const ordered_json* moved = target ? find_member(*target, "node") : nullptr;
            if (moved && *moved == node) return true;
        }
    }
    return false;
}

}  // namespace neuvv::edit
