#include "edit/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "base/error.h"

namespace neuvv::edit {

namespace {

bool uses_extension(const ordered_json& json, const char* name) {
    if (json.is_object() && json.contains("extensions") && json["extensions"].is_object() &&
        json["extensions"].contains(name))
        return true;
    return json.is_structured() &&
           std::any_of(json.begin(), json.end(), [&](const ordered_json& part) { return uses_extension(part, name); });
}

glm::dvec3 vector_in(const ordered_json& node, const char* name, const glm::dvec3& fallback) {
    if (!node.contains(name)) return fallback;
    return {node[name][0].get<double>(), node[name][1].get<double>(), node[name][2].get<double>()};
}

void expect_node(const stage::StageFile& file, uint32_t node) {
    if (node >= node_count(file))
        throw InputError(file.path.string(), "/nodes", fmt::format("node {} does not exist", node));
}

}  // namespace

std::optional<uint64_t> index_of(const ordered_json& value) {
    if (value.is_number_unsigned()) return value.get<uint64_t>();
    if (value.is_number_integer() && value.get<int64_t>() >= 0) return static_cast<uint64_t>(value.get<int64_t>());
    return {};
}

const ordered_json* find_member(const ordered_json& owner, const char* name) {
    const auto found = owner.find(name);  // the end where the owner is no object
    return found == owner.end() ? nullptr : &*found;
}

const ordered_json* find_member(const stage::StageJson& document, const char* name) {
    return document.find(name);
}

ordered_json& node_of(stage::StageFile& file, uint32_t node) {
    expect_node(file, node);
    return file.json.edit("nodes")[node];
}

const ordered_json& node_of(const stage::StageFile& file, uint32_t node) {
    expect_node(file, node);
    return file.json["nodes"][node];
}

std::string title_of(const stage::StageFile& file, uint32_t node) {
    const std::string name = name_of(file, node);
    return name.empty() ? fmt::format("node {}", node) : fmt::format("\"{}\" (node {})", name, node);
}

const ordered_json* find_extension(const ordered_json& owner, const char* name) {
    const ordered_json* extensions = find_member(owner, "extensions");
    const ordered_json* found = extensions ? find_member(*extensions, name) : nullptr;
    return found && found->is_object() ? found : nullptr;
}

ordered_json* find_extension(ordered_json& owner, const char* name) {
    return const_cast<ordered_json*>(find_extension(std::as_const(owner), name));
}

const ordered_json* find_extension(const stage::StageJson& document, const char* name) {
    const ordered_json* extensions = document.find("extensions");
    const ordered_json* found = extensions ? find_member(*extensions, name) : nullptr;
    return found && found->is_object() ? found : nullptr;
}

ordered_json* find_extension(stage::StageJson& document, const char* name) {
    return find_extension(std::as_const(document), name) ? &document.edit("extensions")[name] : nullptr;
}

ordered_json& make_extension(const stage::StageFile& file, ordered_json& owner, const char* name) {
    if (!owner.contains("extensions")) owner["extensions"] = ordered_json::object();
    if (!owner["extensions"].is_object())
        throw InputError(file.path.string(), "extensions", "is not an object", "correct the file");
    if (ordered_json* found = find_extension(owner, name)) return *found;
    return owner["extensions"][name] = ordered_json::object();
}

ordered_json& make_extension(stage::StageFile& file, const char* name) {
    if (ordered_json* found = find_extension(file.json, name)) return *found;
    if (!file.json.contains("extensions")) file.json.set("extensions", ordered_json::object());
    if (!file.json["extensions"].is_object())
        throw InputError(file.path.string(), "extensions", "is not an object", "correct the file");
    return file.json.edit("extensions")[name] = ordered_json::object();
}

void declare_extension(stage::StageFile& file, const char* name) {
    ordered_json& used = list_in(file.json, "extensionsUsed");
    if (std::find(used.begin(), used.end(), ordered_json(name)) == used.end()) used.push_back(name);
}

void remove_extension(ordered_json& owner, const char* name) {
    if (!owner.contains("extensions") || !owner["extensions"].is_object()) return;
    owner["extensions"].erase(name);
    if (owner["extensions"].empty()) owner.erase("extensions");
}

void remove_extension(stage::StageJson& document, const char* name) {
    const ordered_json* extensions = document.find("extensions");
    if (!extensions || !extensions->is_object()) return;
    document.edit("extensions").erase(name);
    if (document["extensions"].empty()) document.erase("extensions");
}

void undeclare_unused(stage::StageFile& file, const char* name) {
    if (find_extension(file.json, name)) return;
    for (const auto& [member, value] : file.json.members())
        if (uses_extension(*value, name)) return;
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
        if (!file.json.contains(list) || !file.json[list].is_array()) continue;
        ordered_json& names = file.json.edit(list);
        for (size_t i = names.size(); i-- > 0;)
            if (names[i] == name) names.erase(i);
        if (names.empty()) file.json.erase(list);
    }
}

const ordered_json& performer_of(const stage::StageFile& file, uint32_t node) {
    const ordered_json* performer = find_extension(node_of(file, node), stage::kPerformerExtension);
    if (!performer)
        throw InputError(file.path.string(), fmt::format("/nodes/{}", node),
                         fmt::format("{} is no performer", title_of(file, node)), "choose a node that plays a .nvv");
    return *performer;
}

ordered_json& performer_of(stage::StageFile& file, uint32_t node) {
    performer_of(std::as_const(file), node);  // throws where there is none
    return *find_extension(node_of(file, node), stage::kPerformerExtension);
}

ordered_json& list_in(ordered_json& json, const char* name) {
    if (!json.contains(name)) json[name] = ordered_json::array();
    if (!json[name].is_array()) throw InputError("stage", name, "is not a list", "correct the file");
    return json[name];
}

ordered_json& list_in(stage::StageJson& json, const char* name) {
    if (!json.contains(name)) json.set(name, ordered_json::array());
    if (!json[name].is_array()) throw InputError("stage", name, "is not a list", "correct the file");
    return json.edit(name);
}

const ordered_json* find_scene(const stage::StageFile& file) {
    const ordered_json* scenes = find_member(file.json, "scenes");
    if (!scenes || scenes->empty()) return nullptr;
    const size_t scene = file.json.value("scene", size_t{0});
    if (scene >= scenes->size())
        throw InputError(file.path.string(), "/scene", fmt::format("{} does not exist", scene));
    return &(*scenes)[scene];
}

ordered_json& scene_of(stage::StageFile& file) {
    if (list_in(file.json, "scenes").empty()) {
        const std::vector<uint32_t> roots = scene_roots(file);
        file.json.set("scene", 0);
        ordered_json& scene = file.json.edit("scenes").emplace_back(ordered_json::object());
        if (!roots.empty()) scene["nodes"] = roots;
    }
    find_scene(file);  // throws where it does not exist
    return file.json.edit("scenes")[file.json.value("scene", size_t{0})];
}

uint32_t append_node(stage::StageFile& file, ordered_json node) {
    const auto index = static_cast<uint32_t>(list_in(file.json, "nodes").size());
    list_in(scene_of(file), "nodes").push_back(index);
    file.json.edit("nodes").push_back(std::move(node));
    return index;
}

FreeNames::FreeNames(const stage::StageFile& file) {
    for (uint32_t node = 0; node < node_count(file); ++node) taken_.insert(name_of(file, node));
}

std::string FreeNames::take(const std::string& preferred) {
    std::string name = preferred;
    size_t& number = next_.try_emplace(preferred, 2).first->second;
    while (!taken_.insert(name).second) name = fmt::format("{} {}", preferred, number++);
    return name;
}

LocalTransform local_transform_of(const ordered_json& node) {
    LocalTransform transform;
    transform.has_matrix = node.contains("matrix");
    for (int i = 0; i < 16 && transform.has_matrix; ++i)
        transform.matrix[i / 4][i % 4] = node["matrix"][static_cast<size_t>(i)].get<double>();
    transform.translation = vector_in(node, "translation", transform.translation);
    transform.scale = vector_in(node, "scale", transform.scale);
    if (node.contains("rotation")) {
        const ordered_json& q = node["rotation"];
        transform.rotation =
            glm::normalize(glm::dquat(q[3].get<double>(), q[0].get<double>(), q[1].get<double>(), q[2].get<double>()));
    }
    return transform;
}

void set_local_transform(ordered_json& node, const LocalTransform& transform) {
    const LocalTransform before = local_transform_of(node);
    if (transform.has_matrix) {
        for (const char* name : {"translation", "rotation", "scale"}) node.erase(name);
        if (before.has_matrix && before.matrix == transform.matrix) return;
        node["matrix"] = ordered_json::array();
        for (int i = 0; i < 16; ++i) node["matrix"].push_back(transform.matrix[i / 4][i % 4]);
        return;
    }
    node.erase("matrix");
    const glm::dquat& q = transform.rotation;
    if (transform.translation != before.translation) node["translation"] = json_of(transform.translation);
    if (q != before.rotation) node["rotation"] = {q.x, q.y, q.z, q.w};
    if (transform.scale != before.scale) node["scale"] = json_of(transform.scale);
}

glm::dquat rotation_towards(const glm::dvec3& direction) {
    const glm::dvec3 back = -glm::normalize(direction);
    const glm::dvec3 up = std::abs(back.y) < 0.999 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    const glm::dvec3 right = glm::normalize(glm::cross(up, back));
    return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)));
}

LocalTransform turned_about(LocalTransform transform, const glm::dvec3& centre, double angle_rad) {
    const glm::dquat turn = glm::angleAxis(angle_rad, glm::dvec3(0, 1, 0));
    if (transform.has_matrix) {
        glm::dmat4 about = glm::translate(glm::dmat4(1), centre) * glm::mat4_cast(turn);
        transform.matrix = glm::translate(about, -centre) * transform.matrix;
    } else {
        transform.translation = centre + turn * (transform.translation - centre);
        transform.rotation = turn * transform.rotation;
    }
    return transform;
}

glm::dvec3 position_of(const LocalTransform& transform) {
    return transform.has_matrix ? glm::dvec3(transform.matrix[3]) : transform.translation;
}

ordered_json json_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

std::string text_of(const glm::dvec3& v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

}  // namespace neuvv::edit
