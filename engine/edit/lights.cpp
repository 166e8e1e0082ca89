#include <fmt/format.h>

#include "base/error.h"
#include "edit/document.h"
#include "edit/operations.h"

namespace neuvv::edit {

namespace {

constexpr double kDefaultCandela = 100;

// The light on a node. Throws InputError where the node has none.
ordered_json& light_of(stage::StageFile& file, uint32_t node) {
    ordered_json* reference = find_extension(node_of(file, node), kLightsExtension);
    ordered_json* lights = find_extension(file.json, kLightsExtension);
    if (!reference || !lights)
        throw InputError(file.path.string(), fmt::format("/nodes/{}", node),
                         fmt::format("{} is no light", title_of(file, node)));
    return (*lights)["lights"].at((*reference)["light"].get<size_t>());
}

size_t users_of(const stage::StageFile& file, size_t light) {
    size_t count = 0;
    for (const ordered_json& node : file.json["nodes"])
        if (const ordered_json* reference = find_extension(node, kLightsExtension))
            count += (*reference)["light"] == light;
    return count;
}

void edit_light(ordered_json& light, const LightEdit& edit) {
    if (edit.kind) light["type"] = *edit.kind;
    if (edit.color) light["color"] = json_of(*edit.color);
    if (edit.intensity) light["intensity"] = *edit.intensity;
    if (edit.range_m && *edit.range_m == 0) light.erase("range");
    if (edit.range_m && *edit.range_m != 0) light["range"] = *edit.range_m;
    if (light["type"] != "spot") {
        light.erase("spot");
        return;
    }
    ordered_json& spot = light["spot"];
    if (!spot.is_object()) spot = ordered_json::object();
    if (edit.inner_cone_deg) spot["innerConeAngle"] = glm::radians(*edit.inner_cone_deg);
    if (edit.outer_cone_deg) spot["outerConeAngle"] = glm::radians(*edit.outer_cone_deg);
}

// What was changed, as a phrase.
std::string changes_of(const LightEdit& edit, const ordered_json& light) {
    std::string text;
    const auto also = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (edit.kind) also(*edit.kind);
    if (edit.color) also("colour " + text_of(*edit.color));
    if (edit.intensity)
        also(fmt::format("{:.6g} {}", *edit.intensity, light["type"] == "directional" ? "lux" : "candela"));
    if (edit.range_m) also(*edit.range_m == 0 ? "endless" : fmt::format("ends {:.6g} m off", *edit.range_m));
    if (light["type"] == "spot") {
        if (edit.inner_cone_deg) also(fmt::format("full light up to {:.6g}°", *edit.inner_cone_deg));
        if (edit.outer_cone_deg) also(fmt::format("none from {:.6g}°", *edit.outer_cone_deg));
    }
    return text.empty() ? "as it was" : text;
}

}  // namespace

std::string add_light(stage::StageFile& file, const std::string& name, const LightEdit& edit,
                      const Placement& placement) {
    return all_or_nothing(file, [&] {
        const uint32_t node = append_node(file, {{"name", FreeNames(file).take(name.empty() ? "light" : name)}});
        declare_extension(file, kLightsExtension);
        ordered_json& lights = list_in(make_extension(file, kLightsExtension), "lights");
        const size_t index = lights.size();
        lights.push_back({{"type", "spot"}, {"intensity", kDefaultCandela}});
        edit_light(lights[index], edit);
        const std::string kind = lights[index]["type"].get<std::string>(), changes = changes_of(edit, lights[index]);
        make_extension(file, node_of(file, node), kLightsExtension)["light"] = index;
        return fmt::format("added {} light {}, {}", kind, place_node(file, node, placement), changes);
    });
}

std::string set_light(stage::StageFile& file, uint32_t node, const LightEdit& edit) {
    ordered_json changed = light_of(file, node);
    edit_light(changed, edit);
    ordered_json& reference = *find_extension(node_of(file, node), kLightsExtension);
    ordered_json& lights = (*find_extension(file.json, kLightsExtension))["lights"];
    if (users_of(file, reference["light"].get<size_t>()) > 1) {
        reference["light"] = lights.size();
        lights.push_back(ordered_json());
    }
    lights[reference["light"].get<size_t>()] = changed;
    return fmt::format("{}: {}", title_of(file, node), changes_of(edit, changed));
}

std::string remove_light(stage::StageFile& file, uint32_t node) {
    light_of(file, node);
    return remove_node(file, node);
}

}  // namespace neuvv::edit
