// For this module alone: finding values in the JSON of a stage, to read and to change them.
//
// A reference into an ordered_json becomes invalid when its object gets a new member: so scene_of and append_node are
// called before references into the same list are taken. A reference into a member of the document becomes invalid with
// the next copy of the document (stage/file/stage_json.h): so operations copy the document before they take references,
// as all_or_nothing does.
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

// Returns what `edit` returns; where it throws, the document is as it was. Members that `edit` wrote to without
// changing them are shared with the document as it was before.
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

// The value as an index; nullopt where it is none.
std::optional<uint64_t> index_of(const ordered_json& value);

// owner[name]; null where it is missing or the owner is no object.
const ordered_json* find_member(const ordered_json& owner, const char* name);
const ordered_json* find_member(const stage::StageJson& document, const char* name);

// nodes[node], to be written to or only read. Throws InputError where the node does not exist.
ordered_json& node_of(stage::StageFile& file, uint32_t node);
const ordered_json& node_of(const stage::StageFile& file, uint32_t node);
// The name of a node in messages: "\"anna\" (node 3)".
std::string title_of(const stage::StageFile& file, uint32_t node);

// owner.extensions[name]; null where it is missing or no object.
ordered_json* find_extension(ordered_json& owner, const char* name);
const ordered_json* find_extension(const ordered_json& owner, const char* name);
ordered_json* find_extension(stage::StageJson& document, const char* name);
const ordered_json* find_extension(const stage::StageJson& document, const char* name);
// The same, added where it is missing. The document must declare the extension, too (declare_extension). Throws
// InputError where `extensions` is no object.
ordered_json& make_extension(const stage::StageFile& file, ordered_json& owner, const char* name);
ordered_json& make_extension(stage::StageFile& file, const char* name);  // on the document itself
// Lists the extension in the document's extensionsUsed.
void declare_extension(stage::StageFile& file, const char* name);
// Removes the extension from its owner, and the owner's `extensions` where that becomes empty.
void remove_extension(ordered_json& owner, const char* name);
void remove_extension(stage::StageJson& document, const char* name);
// Removes the extension from the lists of used and required extensions where nothing in the document has it.
void undeclare_unused(stage::StageFile& file, const char* name);

// The performer extension of a node. Throws InputError where the node has none.
ordered_json& performer_of(stage::StageFile& file, uint32_t node);
const ordered_json& performer_of(const stage::StageFile& file, uint32_t node);
// The list json[name], added where it is missing. Throws InputError where it is no list.
ordered_json& list_in(ordered_json& json, const char* name);
ordered_json& list_in(stage::StageJson& json, const char* name);
// The scene that a stage shows; null where the document has no scenes. Throws InputError where the default scene does
// not exist.
const ordered_json* find_scene(const stage::StageFile& file);
// The same. Where the document has no scenes, one is added with all nodes that have no parent.
ordered_json& scene_of(stage::StageFile& file);
// Adds a node at the end of the list of nodes and of the scene. Returns its index.
uint32_t append_node(stage::StageFile& file, ordered_json node);

// Gives names that no node has. Each name is given at most once.
class FreeNames {
  public:
    explicit FreeNames(const stage::StageFile& file);
    // `preferred`, with a number appended where that name is taken.
    std::string take(const std::string& preferred);

  private:
    std::unordered_set<std::string> taken_;
    std::unordered_map<std::string, size_t> next_;  // by preferred name: the number to try next
};

// A node's own transform in the form that the document has: a matrix, or translation, rotation and scale. Metres, in
// the space of the node's parent.
struct LocalTransform {
    bool has_matrix = false;
    glm::dmat4 matrix{1};
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
};
LocalTransform local_transform_of(const ordered_json& node);
// Writes those members of the node that differ from `transform`.
void set_local_transform(ordered_json& node, const LocalTransform& transform);
// The rotation whose −Z is `direction` and whose +Y is as upright as possible.
glm::dquat rotation_towards(const glm::dvec3& direction);
// The transform turned about the vertical axis through `centre`, counter-clockwise as seen from above.
LocalTransform turned_about(LocalTransform transform, const glm::dvec3& centre, double angle_rad);
glm::dvec3 position_of(const LocalTransform& transform);

ordered_json json_of(const glm::dvec3& v);
std::string text_of(const glm::dvec3& v);

}  // namespace neuvv::edit
