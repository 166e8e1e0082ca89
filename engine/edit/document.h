// For this module alone: finding one's way in a stage's JSON, to read it and to change it.
//
// References into an ordered_json do not outlive a new member of an object that holds them: scene_of and append_node
// come before references into the same list are taken. References into a member of the document do not outlive its next
// copy (stage/stage_json.h), so operations copy it first, as all_or_nothing does.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "edit/read.h"

namespace neuvv::edit {

using nlohmann::ordered_json;

constexpr const char* kLightsExtension = "KHR_lights_punctual";

// What `edit` returns; where it throws, the document is as it was. Members that it wrote without changing them are
// shared with the document before it.
template <typename Edit>
std::string all_or_nothing(stage::StageFile& file, const Edit& edit) {
    stage::StageJson before = file.json;
    try {
        std::string what = edit();
        file.json.share(before);
        return what;
    } catch (...) {
        file.json = std::move(before);
        throw;
    }
}

// An index as JSON has it; nothing where the value is none.
std::optional<uint64_t> index_of(const ordered_json& value);

// owner[name], null where it is not there or the owner is no object.
const ordered_json* find_member(const ordered_json& owner, const char* name);
const ordered_json* find_member(const stage::StageJson& document, const char* name);

// nodes[node]; throws InputError where it does not exist. To be written, or only read.
ordered_json& node_of(stage::StageFile& file, uint32_t node);
const ordered_json& node_of(const stage::StageFile& file, uint32_t node);
// "\"anna\" (node 3)".
std::string title_of(const stage::StageFile& file, uint32_t node);

// owner.extensions[name], null where it is not there.
ordered_json* find_extension(ordered_json& owner, const char* name);
const ordered_json* find_extension(const ordered_json& owner, const char* name);
ordered_json* find_extension(stage::StageJson& document, const char* name);
const ordered_json* find_extension(const stage::StageJson& document, const char* name);
// The same, made where it is missing. The document must have been told: declare_extension.
ordered_json& make_extension(const stage::StageFile& file, ordered_json& owner, const char* name);
ordered_json& make_extension(stage::StageFile& file, const char* name);  // of the document itself
// The document says that it uses it.
void declare_extension(stage::StageFile& file, const char* name);
// Takes it away, and what is empty thereby.
void remove_extension(ordered_json& owner, const char* name);
void remove_extension(stage::StageJson& document, const char* name);
// The document no longer says that it uses an extension that nothing has.
void undeclare_unused(stage::StageFile& file, const char* name);

// The performer on a node; throws InputError where there is none.
ordered_json& performer_of(stage::StageFile& file, uint32_t node);
const ordered_json& performer_of(const stage::StageFile& file, uint32_t node);
// The list json[name], made where it is missing.
ordered_json& list_in(ordered_json& json, const char* name);
ordered_json& list_in(stage::StageJson& json, const char* name);
// The scene that a stage shows, null where the document has none.
const ordered_json* find_scene(const stage::StageFile& file);
// The same, made of all nodes that have no parent where the document has none.
ordered_json& scene_of(stage::StageFile& file);
// A node at the end of the list and of the scene; returns its index.
uint32_t append_node(stage::StageFile& file, ordered_json node);

// Names that no node has: the one that is wanted, or with a number behind it. Each is given once.
class FreeNames {
  public:
    explicit FreeNames(const stage::StageFile& file);
    std::string take(const std::string& wanted);

  private:
    std::unordered_set<std::string> taken_;
    std::unordered_map<std::string, size_t> next_;  // by wanted name: the number to be tried
};

// A node's own transform in two forms, whichever the document has.
struct LocalTransform {
    bool has_matrix = false;
    glm::dmat4 matrix{1};
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
};
LocalTransform local_transform_of(const ordered_json& node);
// Writes those members that differ from what the node says.
void set_local_transform(ordered_json& node, const LocalTransform& transform);
// The rotation whose −Z is `direction` and whose +Y is as upright as may be.
glm::dquat rotation_towards(const glm::dvec3& direction);
// Turned about a vertical axis through `middle`, counter-clockwise seen from above.
LocalTransform turned_about(LocalTransform transform, const glm::dvec3& middle, double angle_rad);
glm::dvec3 position_of(const LocalTransform& transform);

ordered_json json_of(const glm::dvec3& v);
std::string text_of(const glm::dvec3& v);

}  // namespace neuvv::edit
