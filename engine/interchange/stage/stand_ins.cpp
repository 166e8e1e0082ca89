#include "interchange/stage/stand_ins.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "interchange/splats/splat_gltf.h"
#include "stage/gltf/embedded.h"

namespace neuvv::interchange {

namespace {

using Json = nlohmann::ordered_json;

// In the extras of a mesh of splats that stands in for a performer.
constexpr const char* kMark = "neuvvStandIn";

bool is_marked(const Json& mesh) {
    const auto extras = mesh.find("extras");
    return extras != mesh.end() && extras->is_object() && extras->contains(kMark);
}

std::string name_of(const Json& node) {
    const auto name = node.find("name");
    return name != node.end() && name->is_string() ? name->get<std::string>() + " " : "";
}

void use_extension(Json& document) {
    Json& used = document["extensionsUsed"];
    if (!used.is_array()) used = Json::array();
    if (std::find(used.begin(), used.end(), kSplatExtension) == used.end()) used.push_back(kSplatExtension);
}

}  // namespace

bool has_stand_ins(const stage::Stage& stage) {
    for (const stage::StagePerformer& performer : stage.performers)
        for (const uint32_t child : stage.scene.nodes[performer.node].children)
            if (const int32_t mesh = stage.scene.nodes[child].mesh; mesh >= 0)
                if (is_marked(stage.file.json["meshes"][static_cast<size_t>(mesh)])) return true;
    return false;
}

void write_stand_ins(const std::filesystem::path& output, const stage::Stage& stage, std::span<const Splats> splats,
                     std::span<const StandIn> stand_ins) {
    stage::GlbWriter glb = stage::embedded(stage.file, output);
    const size_t first_mesh = glb.json.contains("meshes") ? glb.json["meshes"].size() : 0;
    for (const Splats& shown : splats) {
        Json mesh = add_splat_mesh(shown, glb);
        mesh["extras"][kMark] = true;
        glb.json["meshes"].push_back(std::move(mesh));
    }
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
    if (glb.bytes.size() > stage::kMaxStageBytes - stage::kMaxStageJsonBytes)
        throw InputError(output.string(), "",
                         fmt::format("would have {:.1f} GB, more than stages may have",
                                     1e-9 * static_cast<double>(glb.bytes.size())),
                         Remedy::kFewerSplats);
    glb.write(output, Remedy::kFewerSplats);
}

}  // namespace neuvv::interchange
