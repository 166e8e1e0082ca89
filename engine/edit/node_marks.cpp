// Whether a node is visible, and whether it is locked.
#include <fmt/format.h>

#include "base/error.h"
#include "edit/document.h"
#include "edit/operations.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::edit {

namespace {

// extras.neuvv of a node; null where it is missing or no object.
const ordered_json* our_extras(const ordered_json& node) {
    const ordered_json* extras = find_member(node, "extras");
    const ordered_json* ours = extras ? find_member(*extras, "neuvv") : nullptr;
    return ours && ours->is_object() ? ours : nullptr;
}

void remove_lock(ordered_json& node) {
    if (!our_extras(node)) return;
    ordered_json& extras = node["extras"];
    extras["neuvv"].erase("locked");
    if (extras["neuvv"].empty()) extras.erase("neuvv");
    if (extras.empty()) node.erase("extras");
}

void add_lock(const stage::StageFile& file, uint32_t index, ordered_json& node) {
    ordered_json& extras = node["extras"];
    const bool usable = extras.is_null() || extras.is_object();
    if (!usable || (extras.contains("neuvv") && !extras["neuvv"].is_object()))
        throw InputError(file.path.string(), fmt::format("/nodes/{}/extras", index),
                         "is no object, and cannot say that the node is locked", "take it out");
    extras["neuvv"]["locked"] = true;
}

}  // namespace

std::string show_node(stage::StageFile& file, uint32_t node, bool visible) {
    node_of(file, node);
    if (visible) {
        remove_extension(node_of(file, node), stage::kVisibilityExtension);
        if (ordered_json* performer = find_extension(node_of(file, node), stage::kPerformerExtension))
            performer->erase("visible");
        undeclare_unused(file, stage::kVisibilityExtension);
    } else {
        declare_extension(file, stage::kVisibilityExtension);
        make_extension(file, node_of(file, node), stage::kVisibilityExtension)["visible"] = false;
    }
    return fmt::format("{}: {}", title_of(file, node), visible ? "shown" : "hidden, and what hangs on it");
}

bool is_visible(const stage::StageFile& file, uint32_t node) {
    const ordered_json& json = node_of(file, node);
    for (const char* extension : {stage::kVisibilityExtension, stage::kPerformerExtension})
        if (const ordered_json* found = find_extension(json, extension))
            if (!found->value("visible", true)) return false;
    return true;
}

std::string lock_node(stage::StageFile& file, uint32_t node, bool locked) {
    return all_or_nothing(file, [&] {
        ordered_json& json = node_of(file, node);
        if (locked)
            add_lock(file, node, json);
        else
            remove_lock(json);
        return fmt::format("{}: {}", title_of(file, node), locked ? "locked" : "not locked");
    });
}

bool has_sound(const stage::StageFile& file, uint32_t node) {
    const ordered_json* performer = find_extension(node_of(file, node), stage::kPerformerExtension);
    return performer && find_member(*performer, "sound");
}

bool is_locked(const stage::StageFile& file, uint32_t node) {
    const ordered_json* ours = our_extras(node_of(file, node));
    return ours && ours->contains("locked") && (*ours)["locked"] == true;
}

}  // namespace neuvv::edit
