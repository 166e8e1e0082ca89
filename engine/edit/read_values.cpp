// Cameras and performers on nodes, and the settings of the stage as a whole.
#include <fmt/format.h>

#include "edit/document.h"
#include "edit/read.h"
#include "stage/camera_path_json.h"

namespace neuvv::edit {

namespace {

// The extension NEUVV_stage of the default scene; null where it has none.
const ordered_json* stage_extension(const stage::StageFile& file) {
    const ordered_json* scene = find_scene(file);
    return scene ? find_extension(*scene, stage::kStageExtension) : nullptr;
}

}  // namespace

std::optional<stage::GltfCamera> camera_on(const stage::StageFile& file, uint32_t node) {
    if (node >= node_count(file)) return std::nullopt;
    const ordered_json* index = find_member(node_of(file, node), "camera");
    if (!index) return std::nullopt;
    const ordered_json& json = file.json.at("cameras").at(index->get<size_t>());
    stage::GltfCamera camera;
    if (const ordered_json* name = find_member(json, "name"); name && name->is_string()) camera.name = *name;
    camera.orthographic = json.value("type", "") == "orthographic";
    const ordered_json* perspective = camera.orthographic ? nullptr : find_member(json, "perspective");
    if (perspective) camera.vertical_angle_rad = perspective->value("yfov", 0.0);
    return camera;
}

std::optional<stage::PerformerSettings> performer_on(const stage::StageFile& file, uint32_t node) {
    if (node >= node_count(file)) return std::nullopt;
    const ordered_json* performer = find_extension(node_of(file, node), stage::kPerformerExtension);
    if (!performer) return std::nullopt;
    const std::string place = fmt::format("/nodes/{}/extensions/{}", node, stage::kPerformerExtension);
    return stage::performer_settings_of(*performer, file.path.string(), place);
}

std::filesystem::path clip_of(const stage::StageFile& file, uint32_t node) {
    return stage::file_or_address_of_uri(file, performer_of(file, node).value("uri", ""), title_of(file, node));
}

std::vector<std::filesystem::path> clips_of(const stage::StageFile& file) {
    const std::vector<bool> in_scene = nodes_in_scene(file);
    std::vector<std::filesystem::path> clips;
    for (uint32_t node = 0; node < node_count(file); ++node) {
        if (!in_scene[node] || kind_of(file, node) != NodeKind::kPerformer) continue;
        std::filesystem::path clip = clip_of(file, node);
        if (std::ranges::find(clips, clip) == clips.end()) clips.push_back(std::move(clip));
    }
    return clips;
}

stage::StageSettings stage_settings_of(const stage::StageFile& file) {
    const ordered_json* extension = stage_extension(file);
    if (!extension) return {};
    return stage::stage_settings_of(*extension, file.path.string(), stage::kStageExtension);
}

std::optional<stage::CameraPath> camera_path_of(const stage::StageFile& file) {
    const ordered_json* extension = stage_extension(file);
    const ordered_json* path = extension ? find_member(*extension, "cameraPath") : nullptr;
    if (!path) return std::nullopt;
    return stage::camera_path_of(*path, file.path.string(), "cameraPath");
}

}  // namespace neuvv::edit
