#include "interchange/stand_ins.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "interchange/splat_gltf.h"
#include "stage/embedded.h"
#include "stage/performer_settings.h"

namespace neuvv::interchange {

namespace {

using Json = nlohmann::ordered_json;

// The members of `extensions` and `children` that a file of another program may have given another type.
bool has_extension(const Json& owner, const char* name) {
    const auto extensions = owner.find("extensions");
    return extensions != owner.end() && extensions->is_object() && extensions->contains(name);
}

bool has_splats(const Json& mesh) {
    const Json& primitives = mesh.at("primitives");
    return std::any_of(primitives.begin(), primitives.end(),
                       [](const Json& primitive) { return has_extension(primitive, kSplatExtension); });
}

std::string name_of(const Json& node) {
    const auto name = node.find("name");
    return name != node.end() && name->is_string() ? name->get<std::string>() + " " : "";
}

void use_extension(Json& document) {
    Json& used = document["extensionsUsed"];
    if (std::find(used.begin(), used.end(), kSplatExtension) == used.end()) used.push_back(kSplatExtension);
}

}  // namespace

bool has_stand_ins(const stage::StageFile& file) {
    if (!file.json.contains("nodes") || !file.json.contains("meshes")) return false;
    const Json &nodes = file.json["nodes"], &meshes = file.json["meshes"];
    for (const Json& node : nodes) {
        if (!has_extension(node, stage::kPerformerExtension) || !node.contains("children")) continue;
        for (const Json& child : node["children"]) {
            const Json& below = nodes[child.get<size_t>()];
            if (below.contains("mesh") && has_splats(meshes[below["mesh"].get<size_t>()])) return true;
        }
    }
    return false;
}

void write_stand_ins(const std::filesystem::path& output, const stage::StageFile& file, std::span<const Splats> splats,
                     std::span<const StandIn> stand_ins) {
    stage::GlbWriter glb = stage::embedded(file, output);
    const size_t first_mesh = glb.json.contains("meshes") ? glb.json["meshes"].size() : 0;
    for (const Splats& shown : splats) glb.json["meshes"].push_back(add_splat_mesh(shown, glb));
    for (const StandIn& stand_in : stand_ins) {
        Json& nodes = glb.json["nodes"];
        const size_t mesh = first_mesh + stand_in.splats;
        const std::string name = name_of(nodes[stand_in.node]) + "stand-in";
        if (!glb.json["meshes"][mesh].contains("name")) glb.json["meshes"][mesh]["name"] = name;
        Json child = {{"name", name}, {"mesh", mesh}};
        if (const glm::dquat& turn = stand_in.turn; turn.w != 1) child["rotation"] = {turn.x, turn.y, turn.z, turn.w};
        nodes[stand_in.node]["children"].push_back(nodes.size());
        nodes.push_back(std::move(child));
    }
    if (!splats.empty()) use_extension(glb.json);
    glb.write(output, "choose a lower --most-splats");
}

}  // namespace neuvv::interchange
