// Removing elements of lists to which other parts of the document refer by index.
#include <fmt/format.h>

#include <functional>
#include <map>
#include <set>

#include "base/error.h"
#include "edit/document.h"
#include "edit/operations.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::edit {

namespace {

using Indices = std::set<uint64_t>;

// Extensions whose indices are handled here, or that contain no indices of nodes, meshes, skins, cameras and lights.
constexpr const char* kSafeExtensions[] = {
    "KHR_lights_punctual", "NEUVV_",       "KHR_materials_", "KHR_texture_",  "KHR_mesh_",
    "EXT_mesh_",           "EXT_texture_", "KHR_draco_",     "KHR_gaussian_", stage::kVisibilityExtension};

template <typename Json>
size_t size_of(const Json& json, const char* list) {
    return json.contains(list) ? json[list].size() : 0;
}

// The new index of each element; −1 for removed ones.
std::vector<int64_t> renumbering(size_t size, const Indices& gone) {
    std::vector<int64_t> new_index(size);
    int64_t next = 0;
    for (size_t i = 0; i < size; ++i) new_index[i] = gone.contains(i) ? -1 : next++;
    return new_index;
}

void erase_elements(ordered_json& owner, const char* list, const Indices& gone) {
    for (auto index = gone.rbegin(); index != gone.rend(); ++index) owner[list].erase(*index);
    if (!gone.empty() && owner[list].empty()) owner.erase(list);  // glTF does not allow empty lists
}

void erase_elements(stage::StageJson& document, const char* list, const Indices& gone) {
    if (gone.empty()) return;
    ordered_json& elements = document.edit(list);
    for (auto index = gone.rbegin(); index != gone.rend(); ++index) elements.erase(*index);
    if (elements.empty()) document.erase(list);
}

// Renumbers an index into a list that was renumbered. It is removed from its owner where its element was removed.
void renumber_member(ordered_json& owner, const char* name, const std::vector<int64_t>& new_index) {
    const std::optional<uint64_t> index = owner.contains(name) ? index_of(owner[name]) : std::nullopt;
    if (!index || *index >= new_index.size()) return;
    if (new_index[*index] < 0)
        owner.erase(name);
    else
        owner[name] = static_cast<uint64_t>(new_index[*index]);
}

void renumber_list(ordered_json& owner, const char* name, const std::vector<int64_t>& new_index) {
    if (!owner.contains(name) || !owner[name].is_array()) return;
    Indices gone;
    for (size_t i = 0; i < owner[name].size(); ++i) {
        ordered_json& entry = owner[name][i];
        const std::optional<uint64_t> index = index_of(entry);
        if (!index || *index >= new_index.size()) continue;
        if (new_index[*index] < 0)
            gone.insert(i);
        else
            entry = static_cast<uint64_t>(new_index[*index]);
    }
    erase_elements(owner, name, gone);
}

void for_each(ordered_json& json, const char* list, const std::function<void(ordered_json&)>& action) {
    if (json.contains(list) && json[list].is_array())
        for (ordered_json& element : json[list])
            if (element.is_object()) action(element);
}

void for_each(stage::StageJson& document, const char* list, const std::function<void(ordered_json&)>& action) {
    if (document.contains(list) && document[list].is_array())
        for (ordered_json& element : document.edit(list))
            if (element.is_object()) action(element);
}

// The index of what a node refers to: its mesh, skin or camera, or its light.
std::optional<uint64_t> referenced_index(const ordered_json& node, const char* name) {
    const ordered_json* owner = name == std::string("light") ? find_extension(node, kLightsExtension) : &node;
    return owner && owner->contains(name) ? index_of((*owner)[name]) : std::nullopt;
}

// The elements that nodes of the family refer to and no other node does.
Indices only_used_by(const stage::StageFile& file, const Indices& family, const char* name) {
    Indices inside, outside;
    for (size_t i = 0; i < size_of(file.json, "nodes"); ++i)
        if (const auto index = referenced_index(file.json["nodes"][i], name))
            (family.contains(i) ? inside : outside).insert(*index);
    for (const uint64_t index : outside) inside.erase(index);
    return inside;
}

void expect_no_joint(const stage::StageFile& file, const Indices& family, const Indices& skins) {
    for (size_t s = 0; s < size_of(file.json, "skins"); ++s) {
        if (skins.contains(s)) continue;
        for (const ordered_json& joint : file.json["skins"][s].value("joints", ordered_json::array()))
            if (const auto index = index_of(joint); index && family.contains(*index))
                throw InputError(file.path.string(), fmt::format("/skins/{}", s),
                                 fmt::format("node {} is a joint of it, and moves a mesh that stays", *index),
                                 "remove that mesh first");
    }
}

// Removes the channels of removed nodes, then the samplers that no channel uses any more. Returns whether the animation
// has no channels left.
bool prune_animation(ordered_json& animation, const std::vector<int64_t>& new_index) {
    if (!animation.contains("channels") || !animation["channels"].is_array()) return false;
    ordered_json& channels = animation["channels"];
    Indices gone, used_before, used;
    for (size_t i = 0; i < channels.size(); ++i) {
        if (const auto sampler = index_of(channels[i].value("sampler", ordered_json()))) used_before.insert(*sampler);
        if (!channels[i].contains("target") || !channels[i]["target"].contains("node")) continue;
        renumber_member(channels[i]["target"], "node", new_index);
        if (!channels[i]["target"].contains("node")) gone.insert(i);
    }
    if (gone.empty()) return false;
    erase_elements(animation, "channels", gone);
    if (!animation.contains("channels")) return true;
    for_each(animation, "channels", [&](ordered_json& channel) {
        if (const auto sampler = index_of(channel.value("sampler", ordered_json()))) used.insert(*sampler);
    });
    for (const uint64_t index : used) used_before.erase(index);
    const std::vector<int64_t> samplers = renumbering(size_of(animation, "samplers"), used_before);
    erase_elements(animation, "samplers", used_before);
    for_each(animation, "channels", [&](ordered_json& channel) { renumber_member(channel, "sampler", samplers); });
    return false;
}

void remove_nodes(stage::StageJson& json, const Indices& family) {
    const std::vector<int64_t> new_index = renumbering(size_of(json, "nodes"), family);
    erase_elements(json, "nodes", family);
    for_each(json, "nodes", [&](ordered_json& node) { renumber_list(node, "children", new_index); });
    for_each(json, "scenes", [&](ordered_json& scene) { renumber_list(scene, "nodes", new_index); });
    for_each(json, "skins", [&](ordered_json& skin) {
        renumber_list(skin, "joints", new_index);
        renumber_member(skin, "skeleton", new_index);
    });
    Indices idle;
    for (size_t i = 0; i < size_of(json, "animations"); ++i)
        if (prune_animation(json.edit("animations")[i], new_index)) idle.insert(i);
    erase_elements(json, "animations", idle);
}

void remove_referenced(stage::StageJson& json, const char* list, const char* member, const Indices& gone) {
    if (gone.empty()) return;
    const std::vector<int64_t> new_index = renumbering(size_of(json, list), gone);
    erase_elements(json, list, gone);
    for_each(json, "nodes", [&](ordered_json& node) { renumber_member(node, member, new_index); });
}

void remove_lights(stage::StageFile& file, const Indices& gone) {
    ordered_json* lights = find_extension(file.json, kLightsExtension);
    if (gone.empty() || !lights) return;
    const std::vector<int64_t> new_index = renumbering(size_of(*lights, "lights"), gone);
    erase_elements(*lights, "lights", gone);
    for_each(file.json, "nodes", [&](ordered_json& node) {
        if (ordered_json* light = find_extension(node, kLightsExtension)) renumber_member(*light, "light", new_index);
    });
    if (!lights->contains("lights")) remove_extension(file.json, kLightsExtension);
}

// The extensions that may contain indices which were renumbered.
std::string doubtful_extensions(const stage::StageFile& file) {
    std::string names;
    for (const ordered_json& used : file.json.value("extensionsUsed", ordered_json::array())) {
        const std::string name = used.is_string() ? used.get<std::string>() : "?";
        bool safe = false;
        for (const char* known : kSafeExtensions) safe = safe || name.starts_with(known);
        if (!safe) names += (names.empty() ? "" : ", ") + name;
    }
    return names;
}

}  // namespace

std::string remove_node(stage::StageFile& file, uint32_t node) {
    node_of(std::as_const(file), node);  // throws where there is none
    const std::string title = title_of(file, node);
    const std::vector<uint32_t> nodes = family_of(file, node);
    const Indices family(nodes.begin(), nodes.end());
    const Indices skins = only_used_by(file, family, "skin"), meshes = only_used_by(file, family, "mesh"),
                  cameras = only_used_by(file, family, "camera"), lights = only_used_by(file, family, "light");
    expect_no_joint(file, family, skins);
    const bool renumbers = *family.begin() + family.size() < size_of(file.json, "nodes") || !skins.empty() ||
                           !meshes.empty() || !cameras.empty() || !lights.empty();
    const std::string doubtful = renumbers ? doubtful_extensions(file) : "";
    return all_or_nothing(file, [&] {
        remove_referenced(file.json, "skins", "skin", skins);
        remove_referenced(file.json, "meshes", "mesh", meshes);
        remove_referenced(file.json, "cameras", "camera", cameras);
        remove_lights(file, lights);
        remove_nodes(file.json, family);
        for (const char* extension : {stage::kPerformerExtension, kLightsExtension, stage::kVisibilityExtension})
            undeclare_unused(file, extension);
        std::string text = fmt::format("removed {}", title);
        if (family.size() > 1) text += fmt::format(" and {} below it", family.size() - 1);
        if (!doubtful.empty()) text += fmt::format("; {} may name others by index: look at them", doubtful);
        return text;
    });
}

}  // namespace neuvv::edit
