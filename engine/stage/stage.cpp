#include "stage/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "stage/pose.h"
#include "stream/transport/byte_source.h"
#include "voctree/files/clip.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

constexpr double kMinScale = 1e-6, kMaxScale = 1e6, kMinVolume = 1e-6, kMaxPosition_m = 1e9;

// The extension of nodes[index] or scenes[index], null where it has none. The document must be valid glTF.
const ordered_json* extension_of(const StageJson& json, const char* list, size_t index, const char* name) {
    const ordered_json* objects = json.find(list);
    if (!objects || index >= objects->size()) return nullptr;
    const auto extensions = (*objects)[index].find("extensions");
    if (extensions == (*objects)[index].end() || !extensions->is_object()) return nullptr;
    const auto found = extensions->find(name);
    return found == extensions->end() ? nullptr : &*found;
}

std::string extension_place(const char* list, size_t index, const char* name) {
    return fmt::format("/{}/{}/extensions/{}", list, index, name);
}

// The index of a performer's clip in stage.clips; the header of a file that is not there yet is read.
uint32_t clip_of(Stage& stage, const std::filesystem::path& path, const StagePerformer& performer,
                 const std::string& place) {
    for (uint32_t i = 0; i < stage.clips.size(); ++i)
        if (stage.clips[i].path == path) return i;
    try {
        const voctree::ClipHeader header = voctree::read_clip_header(path);
        if (!(header.fps > 0) || header.frames == 0)
            throw InputError(path.string(), "HEAD", "has no frames or no rate");
        stage.clips.push_back({path, header.frames, static_cast<double>(header.fps), header.box_min, header.box_size,
                               std::make_shared<const voctree::ClipIndex>(voctree::read_clip_index(path))});
    } catch (const InputError& problem) {
        throw InputError(stage.file.path.string(), fmt::format("{}/uri of \"{}\"", place, performer.name),
                         problem.cause(), "train it, put it there, or remove the performer");
    }
    return static_cast<uint32_t>(stage.clips.size() - 1);
}

void read_performers(Stage& stage, bool clips_needed) {
    const std::string file = stage.file.path.string();
    for (uint32_t i = 0; i < stage.scene.nodes.size(); ++i) {
        const ordered_json* extension = extension_of(stage.file.json, "nodes", i, kPerformerExtension);
        if (!extension) continue;
        const std::string place = extension_place("nodes", i, kPerformerExtension);
        StagePerformer performer;
        performer.node = i;
        performer.name = node_title(stage.scene, i);
        performer.settings = performer_settings_of(*extension, file, place);
        const std::filesystem::path path = file_or_address_of_uri(stage.file, performer.settings.uri, place + "/uri");
        if (!performer.settings.skeleton_uri.empty())
            performer.skeleton =
                absolute_path(file_of_uri(stage.file, performer.settings.skeleton_uri, place + "/skeleton"));
        if (performer.settings.sound)
            performer.sound = file_or_address_of_uri(stage.file, performer.settings.sound->uri, place + "/sound");
        for (const PaintLayer& layer : performer.settings.paint) file_of_uri(stage.file, layer.uri, place + "/paint");
        if (!stage.scene.nodes[i].in_scene) continue;
        std::error_code error;
        if (clips_needed || (!stream::is_address(path) && std::filesystem::exists(path, error))) {
            performer.clip = clip_of(stage, path, performer, place);
            const StageClip& clip = stage.clips[performer.clip];
            performer.timeline = timeline_of(performer.settings.time, clip.frames, clip.fps, file, place + "/time");
        }
        stage.performers.push_back(std::move(performer));
    }
}

// Checks the nodes' transforms without animations; stage_at checks them again at its time, animated.
void expect_valid_transforms(const Stage& stage) {
    const std::string file = stage.file.path.string();
    const PosedScene pose = pose_scene(stage.scene, kNoAnimation, 0);
    for (const StagePerformer& performer : stage.performers)
        if (!is_valid_transform(pose.world_from_node[performer.node]))
            throw InputError(file, fmt::format("/nodes/{}", performer.node),
                             fmt::format("the transform of \"{}\" is flat, too large or not finite, together with "
                                         "those of the nodes above it",
                                         performer.name),
                             "give it a scale that is not 0");
    for (uint32_t i = 0; i < stage.scene.nodes.size(); ++i)
        if (stage.scene.nodes[i].in_scene && !is_on_stage(pose.world_from_node[i]))
            throw InputError(file, fmt::format("/nodes/{}", i),
                             fmt::format("\"{}\" stands farther than {} m from the origin, or nowhere",
                                         node_title(stage.scene, i), kMaxPosition_m),
                             "look at its transform and those of the nodes above it");
}

// How long a performer plays: until its time map ends, or as long as its clip where the time map is endless.
double performance_s(const Stage& stage, const StagePerformer& performer) {
    if (stage.clips.empty()) return 0;  // expect_sound_document allows missing clips
    const StageClip& clip = stage.clips[performer.clip];
    const double length = length_s(performer.timeline);
    return std::isfinite(length) ? length : clip.frames / clip.fps;
}

void read_settings(Stage& stage) {
    const int32_t root = stage.scene.root;
    if (root >= 0)
        if (const ordered_json* extension =
                extension_of(stage.file.json, "scenes", static_cast<size_t>(root), kStageExtension)) {
            const std::string place = extension_place("scenes", static_cast<size_t>(root), kStageExtension);
            stage.settings = stage_settings_of(*extension, stage.file.path.string(), place);
            if (stage.settings.environment)
                file_of_uri(stage.file, stage.settings.environment->uri, place + "/environment/uri");
        }
    double longest_s = 0;
    for (const StagePerformer& performer : stage.performers)
        longest_s = std::max(longest_s, performance_s(stage, performer));
    for (const GltfAnimation& animation : stage.scene.animations) longest_s = std::max(longest_s, animation.duration_s);
    if (stage.settings.camera_path) longest_s = std::max(longest_s, stage.settings.camera_path->duration_s);
    stage.duration_s = stage.settings.duration_s.value_or(std::min(longest_s, kMaxStageSeconds));
    stage.fps = stage.settings.fps.value_or(
        stage.clips.empty() ? 25 : std::clamp(stage.clips[0].fps, kMinStageFps, kMaxStageFps));
    stage.ambient = stage.settings.ambient.value_or(glm::dvec3(stage.scene.lights.empty() ? 1 : 0));
}

// The members that name buffers and images, and those whose content is read from such bytes: expensive to load.
constexpr const char* kExpensiveMembers[] = {"buffers",  "bufferViews", "accessors", "images", "textures",
                                             "samplers", "materials",   "meshes",    "skins",  "animations"};

std::vector<std::pair<std::filesystem::path, FileStamp>> read_files_of(const StageFile& file) {
    std::vector<std::pair<std::filesystem::path, FileStamp>> files;
    for (const char* list : {"buffers", "images"}) {
        const ordered_json* owners = file.json.find(list);
        if (!owners || !owners->is_array()) continue;
        for (const ordered_json& owner : *owners) {
            if (!owner.is_object() || !owner.contains("uri") || !owner["uri"].is_string()) continue;
            const auto& uri = owner["uri"].get_ref<const std::string&>();
            if (uri.starts_with("data:")) continue;
            const std::filesystem::path path = file.path.parent_path() / decoded_uri(uri);
            files.emplace_back(path, stamp_of(path));
        }
    }
    return files;
}

// Whether the chunks behind the JSON, where a .glb has its buffer, are the same.
bool has_same_chunks(const StageFile::Saved& a, const StageFile::Saved& b) {
    if (&a == &b || (!a.binary && !b.binary)) return true;
    return a.binary && b.binary &&
           std::equal(a.bytes.begin() + static_cast<std::ptrdiff_t>(a.json_begin + a.json_size), a.bytes.end(),
                      b.bytes.begin() + static_cast<std::ptrdiff_t>(b.json_begin + b.json_size), b.bytes.end());
}

// Whether the expensive members and the bytes that they name are the same in both, which needs no reading of files.
bool has_same_bytes(const StageFile& file, const Stage& before) {
    const bool same_folder = before.read_files.empty() || file.path.parent_path() == before.file.path.parent_path();
    const bool files_changed = std::any_of(before.read_files.begin(), before.read_files.end(),
                                           [](const auto& read) { return stamp_of(read.first) != read.second; });
    return same_folder && !files_changed && has_same_chunks(*file.saved, *before.file.saved) &&
           std::all_of(std::begin(kExpensiveMembers), std::end(kExpensiveMembers),
                       [&](const char* member) { return file.json.shares(before.file.json, member); });
}

// The document without its expensive members.
std::vector<uint8_t> bytes_of_nodes(const StageFile& file) {
    StageJson json = file.json;
    for (const char* member : kExpensiveMembers) json.erase(member);
    const std::string text = json.text();
    return {text.begin(), text.end()};
}

void read_scene(Stage& stage, const StageFile& file, const Stage* before) {
    if (before && has_same_bytes(file, *before))
        if (auto scene = load_gltf_nodes(file.path, bytes_of_nodes(file), before->scene)) {
            stage.scene = std::move(*scene);
            stage.read_files = before->read_files;
            return;
        }
    stage.read_files = read_files_of(file);
    stage.scene = load_gltf(file.path, stage_bytes(file), before ? &before->scene : nullptr);
}

Stage checked_stage(StageFile file, bool clips_needed, const Stage* before) {
    Stage stage;
    read_scene(stage, file, before);
    stage.file = std::move(file);
    read_performers(stage, clips_needed);
    expect_valid_transforms(stage);
    read_settings(stage);
    return stage;
}

}  // namespace

bool is_on_stage(const glm::dmat4& world_from_node) {
    const glm::dvec3 position(world_from_node[3]);
    return std::abs(position.x) <= kMaxPosition_m && std::abs(position.y) <= kMaxPosition_m &&
           std::abs(position.z) <= kMaxPosition_m;
}

bool is_valid_transform(const glm::dmat4& world_from_node) {
    double volume = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double length = glm::length(glm::dvec3(world_from_node[axis]));
        if (!(length >= kMinScale && length <= kMaxScale)) return false;
        volume *= length;
    }
    return is_on_stage(world_from_node) &&
           std::abs(glm::determinant(glm::dmat3(world_from_node))) >= kMinVolume * volume;
}

std::string node_title(const GltfScene& scene, uint32_t node) {
    return scene.nodes[node].name.empty() ? fmt::format("node {}", node) : scene.nodes[node].name;
}

Stage load_stage(const std::filesystem::path& path) {
    return make_stage(read_stage_file(path));
}

Stage make_stage(StageFile file, const Stage* before) {
    return checked_stage(std::move(file), true, before);
}

void expect_sound_document(const StageFile& file, const Stage* before) {
    checked_stage(file, false, before);
}

}  // namespace neuvv::stage
