#include "tools/stage/stage_verbs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/formats/json.h"
#include "edit/operations.h"
#include "gpu/device.h"
#include "render/clips/light_status.h"
#include "render/clips/uploaded_segment.h"
#include "render/frame/frame_renderer.h"
#include "stage/camera_path_json.h"
#include "stage/evaluated_stage.h"
#include "tools/report.h"
#include "tools/say.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

namespace {

using nlohmann::ordered_json;

// The memory of a clip on the device: of its field with its far levels, and of the slices that are kept of it.
struct ClipMemory {
    uint64_t field_bytes = 0, slice_bytes = 0;
};

uint64_t slice_bytes_of(const gpu::Device& device, const render::Field& field, uint64_t budget) {
    const uint64_t before = device.buffer_bytes();
    const render::Paints paints(device, field);
    const render::Performer performer(device, field, paints, budget);
    return device.buffer_bytes() - before;
}

std::vector<ClipMemory> measure_memory(const stage::Stage& stage, const StageInfoOptions& options,
                                       const CommonOptions& common) {
    const gpu::Device device(common.device);
    const uint64_t budget = bytes_of_mebibytes(options.slice_budget_mb);
    std::vector<ClipMemory> all;
    size_t fields = 0;
    for (const stage::StageClip& clip : stage.clips) fields += voctree::read_clip_index(clip.path).segments.size();
    for (const stage::StageClip& clip : stage.clips) {
        ClipMemory memory;
        for (const voctree::ClipSegment& segment : voctree::read_clip_index(clip.path).segments) {
            const uint64_t before = device.buffer_bytes();
            const render::Field field = render::upload_segment(device, segment).field;
            memory.field_bytes += device.buffer_bytes() - before;
            const uint64_t share = render::slice_share(budget, fields);
            memory.slice_bytes += slice_bytes_of(device, field, share);
            for (const render::Field& level : field.coarser)
                memory.slice_bytes += slice_bytes_of(device, level, render::slice_share_of_level(share, field, level));
        }
        all.push_back(memory);
    }
    return all;
}

ordered_json vector_json(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

const char* kind_name(stage::GltfLightKind kind) {
    return kind == stage::GltfLightKind::kSpot    ? "spot"
           : kind == stage::GltfLightKind::kPoint ? "point"
                                                  : "directional";
}

// The rotation of a performer's node in degrees about the world's X, then Y, then Z, as --turn has them, and its scale
// along its axes, whose X is negative for a mirror image. Shear is left out.
struct TurnAndScale {
    glm::dvec3 turn_deg{0}, scale{1};
};

TurnAndScale turn_and_scale_of(const glm::dmat4& world_from_node) {
    glm::dmat3 axes(world_from_node);
    TurnAndScale result;
    for (int i = 0; i < 3; ++i) result.scale[i] = glm::length(axes[i]);
    if (glm::determinant(axes) < 0) result.scale.x = -result.scale.x;
    for (int i = 0; i < 3; ++i) axes[i] /= result.scale[i] != 0 ? result.scale[i] : 1;
    result.turn_deg =
        glm::degrees(glm::dvec3(std::atan2(axes[1][2], axes[2][2]), std::asin(std::clamp(-axes[0][2], -1.0, 1.0)),
                                std::atan2(axes[0][1], axes[0][0])));
    return result;
}

const stage::GltfLight& light_of(const stage::Stage& stage, const stage::EvaluatedLight& light) {
    return stage.scene.lights[static_cast<size_t>(stage.scene.nodes[light.node].light)];
}

ordered_json paint_json(const stage::PerformerSettings& settings) {
    auto list = ordered_json::array();
    for (const stage::PaintLayer& layer : settings.paint) list.push_back(stage::json_of(layer));
    return list;
}

ordered_json performers_json(const stage::Stage& stage, const stage::EvaluatedStage& evaluated) {
    auto list = ordered_json::array();
    for (const stage::EvaluatedPerformer& at : evaluated.performers) {
        const stage::StagePerformer& performer = stage.performers[at.performer];
        const stage::PerformerSettings& settings = performer.settings;
        const double length = stage::length_s(performer.timeline);
        const TurnAndScale transform = turn_and_scale_of(evaluated.pose.world_from_node[performer.node]);
        list.push_back({{"node", performer.node},
                        {"name", performer.name},
                        {"clip", at.clip},
                        {"time", stage::text_of(settings.time)},
                        {"seconds", std::isfinite(length) ? ordered_json(length) : ordered_json()},
                        {"frame", at.frame},
                        {"position", vector_json(glm::dvec3(at.world_from_performer[3]))},
                        {"turn", vector_json(transform.turn_deg)},
                        {"scale", vector_json(transform.scale)},
                        {"spin", settings.spin_deg_per_s},
                        {"visible", at.visible},
                        {"opacity", settings.opacity},
                        {"casts_shadow", at.casts_shadow},
                        {"receives_shadow", at.receives_shadow},
                        {"skeleton", settings.skeleton_uri},
                        {"sound", settings.sound ? stage::json_of(*settings.sound) : ordered_json()},
                        {"paint_layers", settings.paint.size()},
                        {"paint", paint_json(settings)}});
    }
    return list;
}

ordered_json light_json(const stage::Stage& stage, const stage::EvaluatedLight& light,
                        const render::LightStatus& status) {
    const stage::GltfLight& source = light_of(stage, light);
    ordered_json json = {{"node", light.node},
                         {"name", stage::node_title(stage.scene, light.node)},
                         {"kind", kind_name(light.kind)},
                         {"position", vector_json(light.position)},
                         {"direction", vector_json(light.direction)},
                         {"intensity", vector_json(light.intensity)},
                         {"colour", vector_json(source.color)},
                         {"range", source.range_m > 0 ? ordered_json(source.range_m) : ordered_json()},
                         {"shines", status.shines},
                         {"casts_shadow", status.casts_shadow},
                         {"limited", !status.text.empty()}};
    if (light.kind == stage::GltfLightKind::kSpot)
        json["cone"] = {glm::degrees(source.inner_cone_rad), glm::degrees(source.outer_cone_rad)};
    return json;
}

ordered_json json_of(const stage::Stage& stage, const stage::EvaluatedStage& evaluated,
                     const std::vector<ClipMemory>& memory) {
    ordered_json json = {{"file", stage.file.path.string()},
                         {"duration", stage.duration_s},
                         {"fps", stage.fps},
                         {"at", evaluated.time_s},
                         {"ambient", vector_json(stage.ambient)},
                         {"background", vector_json(stage.settings.background)},
                         {"blend", stage::kStageBlendNames[static_cast<size_t>(stage.settings.blend)]},
                         {"shadows", stage.settings.shadows},
                         {"falloff", stage.settings.falloff}};
    if (const auto& environment = stage.settings.environment)
        json["environment"] = {
            {"uri", environment->uri}, {"intensity", environment->intensity}, {"rotation", environment->rotation_deg}};
    json["notes"] = stage.scene.notes;
    json["performers"] = performers_json(stage, evaluated);
    json["clips"] = json["lights"] = json["cameras"] = ordered_json::array();
    uint64_t total = 0;
    for (size_t i = 0; i < stage.clips.size(); ++i) {
        const stage::StageClip& clip = stage.clips[i];
        json["clips"].push_back({{"file", clip.path.string()}, {"frames", clip.frames}, {"fps", clip.fps}});
        if (memory.empty()) continue;
        json["clips"].back()["field_bytes"] = memory[i].field_bytes;
        json["clips"].back()["slice_bytes"] = memory[i].slice_bytes;
        total += memory[i].field_bytes + memory[i].slice_bytes;
    }
    if (!memory.empty()) json["device_bytes"] = total;
    const std::vector<render::LightStatus> statuses = render::light_statuses(stage, evaluated);
    for (size_t i = 0; i < statuses.size(); ++i)
        json["lights"].push_back(light_json(stage, evaluated.lights[i], statuses[i]));
    for (const stage::EvaluatedCamera& camera : evaluated.cameras)
        json["cameras"].push_back({{"node", camera.node},
                                   {"name", camera.name},
                                   {"position", vector_json(glm::dvec3(camera.world_from_camera[3]))},
                                   {"degrees", glm::degrees(camera.vertical_angle_rad)},
                                   {"orthographic", camera.orthographic}});
    if (const auto& path = stage.settings.camera_path)
        json["camera_path"] = {{"keys", path->keys.size()},
                               {"first", path->keys.front().time_s},
                               {"last", path->keys.back().time_s},
                               {"interpolation", stage::kInterpolationNames[static_cast<size_t>(path->interpolation)]},
                               {"cyclic", path->cyclic},
                               {"duration", path->duration_s}};
    json["hidden"] = json["locked"] = ordered_json::array();
    for (uint32_t i = 0; i < stage.scene.nodes.size(); ++i) {
        if (!edit::is_visible(stage.file, i)) json["hidden"].push_back(i);
        if (edit::is_locked(stage.file, i)) json["locked"].push_back(i);
    }
    json["meshes"] = stage.scene.meshes.size();
    json["animations"] = stage.scene.animations.size();
    return json;
}

// The names of the nodes for which the predicate is true.
std::string names_of(const stage::Stage& stage, bool (*predicate)(const stage::StageFile&, uint32_t)) {
    std::string names;
    for (uint32_t i = 0; i < stage.scene.nodes.size(); ++i)
        if (predicate(stage.file, i)) names += (names.empty() ? "" : ", ") + stage::node_title(stage.scene, i);
    return names;
}

bool is_hidden(const stage::StageFile& file, uint32_t node) {
    return !edit::is_visible(file, node);
}

std::string position_text(const glm::dvec3& v) {
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x, v.y, v.z);
}

// Adding 0.0 turns −0, and what rounds to it, into 0.
std::string vector_text(const glm::dvec3& v) {
    const auto rounded = [](double number) { return std::round(number * 1e4) / 1e4 + 0.0; };
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", rounded(v.x), rounded(v.y), rounded(v.z));
}

// One number where all three are equal.
std::string numbers_text(const glm::dvec3& v) {
    return glm::length(v - glm::dvec3(v.x)) < 1e-6 ? fmt::format("{:.6g}", v.x) : vector_text(v);
}

std::string paint_text(const stage::PerformerSettings& settings) {
    std::string text;
    for (const stage::PaintLayer& layer : settings.paint) {
        text += (text.empty() ? "" : ", ") + (layer.name.empty() ? stage::decoded_uri(layer.uri) : layer.name);
        if (layer.blend != stage::PaintBlend::kNormal)
            text += fmt::format(" ({})", stage::kPaintBlendNames[static_cast<size_t>(layer.blend)]);
        if (layer.opacity != 1) text += fmt::format(" at {:.6g}", layer.opacity);
        if (!layer.visible) text += " not seen";
    }
    return text;
}

// The time map of a performer, and its settings that differ from the defaults.
std::string settings_text(const stage::StagePerformer& performer, const stage::EvaluatedPerformer& at,
                          const glm::dmat4& world_from_node) {
    const stage::PerformerSettings& settings = performer.settings;
    std::string text = settings.time.empty() ? "as the clip's" : stage::text_of(settings.time);
    const auto [turn_deg, scale] = turn_and_scale_of(world_from_node);
    if (glm::length(turn_deg) > 1e-4) text += fmt::format(", turned by {}°", vector_text(turn_deg));
    if (glm::length(scale - glm::dvec3(1)) > 1e-6) text += ", scaled by " + numbers_text(scale);
    if (settings.spin_deg_per_s != 0) text += fmt::format(", spins {}°/s", settings.spin_deg_per_s);
    if (settings.opacity != 1) text += fmt::format(", opacity {}", settings.opacity);
    if (!at.visible) text += ", not seen";
    if (!settings.casts_shadow) text += ", casts no shadows";
    if (!settings.receives_shadow) text += ", no shadows fall on it";
    if (!settings.skeleton_uri.empty()) text += ", skeleton " + settings.skeleton_uri;
    if (settings.sound) text += fmt::format(", sound {} at {} dB", settings.sound->uri, settings.sound->gain_db);
    if (!settings.paint.empty()) text += ", painted: " + paint_text(settings);
    return text;
}

std::string light_text(const stage::Stage& stage, const stage::EvaluatedLight& light,
                       const render::LightStatus& status) {
    const stage::GltfLight& source = light_of(stage, light);
    std::string text =
        fmt::format("{:.6g} {}", source.intensity, light.kind == stage::GltfLightKind::kDirectional ? "lx" : "cd");
    if (source.color != glm::dvec3(1)) text += ", colour " + numbers_text(source.color);
    if (light.kind == stage::GltfLightKind::kSpot)
        text += fmt::format(", cone {:.4g}° to {:.4g}°", glm::degrees(source.inner_cone_rad),
                            glm::degrees(source.outer_cone_rad));
    if (source.range_m > 0) text += fmt::format(", ends {:.6g} m off", source.range_m);
    if (!status.text.empty()) return text + ", " + status.text;
    return text + (status.casts_shadow ? ", casts shadows" : ", no shadows");
}

std::string settings_text(const stage::Stage& stage) {
    const stage::StageSettings& settings = stage.settings;
    std::string text =
        fmt::format("ambient light {}, background {}", numbers_text(stage.ambient), numbers_text(settings.background));
    if (const auto& environment = settings.environment) {
        text += fmt::format(", environment {}", stage::decoded_uri(environment->uri));
        if (environment->intensity != 1) text += fmt::format(", intensity {:.6g}", environment->intensity);
        if (environment->rotation_deg != 0) text += fmt::format(", turned by {:.6g}°", environment->rotation_deg);
    }
    return text + fmt::format("; blend {}, shadows {}, falloff {}",
                              stage::kStageBlendNames[static_cast<size_t>(settings.blend)],
                              settings.shadows ? "on" : "off", settings.falloff ? "on" : "off");
}

std::string path_text(const stage::CameraPath& path) {
    return fmt::format("camera path: {} keys from {:.6g} s to {:.6g} s, {}{}", path.keys.size(),
                       path.keys.front().time_s, path.keys.back().time_s,
                       stage::kInterpolationNames[static_cast<size_t>(path.interpolation)],
                       path.cyclic ? fmt::format(", back every {:.6g} s", path.duration_s) : "");
}

void print_performers(const stage::Stage& stage, const stage::EvaluatedStage& evaluated) {
    if (evaluated.performers.empty()) return;
    tell("\nnode  performer         clip  frame   at                      time\n");
    for (const stage::EvaluatedPerformer& at : evaluated.performers) {
        const stage::StagePerformer& performer = stage.performers[at.performer];
        tell("{:>4}  {:<16}  {:>4}  {:<6.4g}  {:<22}  {}\n", performer.node, performer.name, at.clip, at.frame,
             position_text(glm::dvec3(at.world_from_performer[3])),
             settings_text(performer, at, evaluated.pose.world_from_node[performer.node]));
    }
}

void print_clips(const stage::Stage& stage, const std::vector<ClipMemory>& memory) {
    uint64_t total = 0;
    if (!stage.clips.empty()) tell("\n");
    for (size_t i = 0; i < stage.clips.size(); ++i) {
        const stage::StageClip& clip = stage.clips[i];
        std::string bytes;
        if (!memory.empty()) {
            bytes = fmt::format(": {} and {} of slices on the device", size_text(memory[i].field_bytes),
                                size_text(memory[i].slice_bytes));
            total += memory[i].field_bytes + memory[i].slice_bytes;
        }
        tell("clip {}  {} frames at {} fps, {}{}\n", i, clip.frames, clip.fps, clip.path.string(), bytes);
    }
    if (!memory.empty()) tell("on the device together {}\n", size_text(total));
}

void print_lights(const stage::Stage& stage, const stage::EvaluatedStage& evaluated) {
    if (evaluated.lights.empty()) return;
    tell("\nnode  light             kind         at                      light\n");
    const std::vector<render::LightStatus> statuses = render::light_statuses(stage, evaluated);
    for (size_t i = 0; i < statuses.size(); ++i) {
        const stage::EvaluatedLight& light = evaluated.lights[i];
        tell("{:>4}  {:<16}  {:<11}  {:<22}  {}\n", light.node, stage::node_title(stage.scene, light.node),
             kind_name(light.kind), position_text(light.position), light_text(stage, light, statuses[i]));
    }
}

void print(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, const std::vector<ClipMemory>& memory) {
    tell("{}: {:.6g} s at {:.6g} fps; {} performers, {} lights, {} cameras, {} meshes, {} animations\n",
         stage.file.path.string(), stage.duration_s, stage.fps, evaluated.performers.size(), evaluated.lights.size(),
         evaluated.cameras.size(), stage.scene.meshes.size(), stage.scene.animations.size());
    tell("{}\n", settings_text(stage));
    if (stage.settings.camera_path) tell("{}\n", path_text(*stage.settings.camera_path));
    if (const std::string hidden = names_of(stage, is_hidden); !hidden.empty()) tell("hidden: {}\n", hidden);
    if (const std::string locked = names_of(stage, edit::is_locked); !locked.empty()) tell("locked: {}\n", locked);
    for (const std::string& note : stage.scene.notes) tell("note: it {}\n", note);
    print_performers(stage, evaluated);
    print_clips(stage, memory);
    print_lights(stage, evaluated);
    if (!evaluated.cameras.empty()) tell("\nnode  camera            angle        at\n");
    for (const stage::EvaluatedCamera& camera : evaluated.cameras)
        tell("{:>4}  {:<16}  {:<11}  {}\n", camera.node, camera.name,
             camera.orthographic ? std::string("orthogr.")
                                 : fmt::format("{:.1f}°", glm::degrees(camera.vertical_angle_rad)),
             position_text(glm::dvec3(camera.world_from_camera[3])));
}

}  // namespace

void print_stage_info(const StageInfoOptions& options, const CommonOptions& common) {
    const stage::Stage stage = stage::load_stage(options.stage);
    expect_time_on_stage(stage, "--at", options.at_s);
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, options.at_s);
    const std::vector<ClipMemory> memory =
        options.memory ? measure_memory(stage, options, common) : std::vector<ClipMemory>();
    if (options.json)
        tell("{}", json_text(json_of(stage, evaluated, memory)));
    else
        print(stage, evaluated, memory);
}

void add_stage_info(Command stage, CommonOptions& common) {
    Command verb = stage.add_verb("info", "Say who and what is on a stage");
    const auto options = std::make_shared<StageInfoOptions>();
    verb.add_option("STAGE", options->stage, "The stage, .gltf or .glb").required();
    verb.add_option("--at", options->at_s, "At which stage time, seconds")
        .number_between(-stage::kMaxStageSeconds, stage::kMaxStageSeconds)
        .show_default();
    verb.add_flag("--json", options->json, "Print JSON");
    verb.add_flag("--memory", options->memory, "Measure what its clips take on a device, each once");
    add_slice_budget_option(verb, options->slice_budget_mb);
    verb.footer({"\n", kDeviceHelp,
                 "\n\nExamples, after those of `neuvv stage add --help`:\n"
                 "  neuvv stage info work/show.gltf\n"
                 "  neuvv stage info work/show.gltf --at 1.5 --json\n"
                 "  neuvv stage info work/show.gltf --memory"});
    verb.callback([options, &common] { print_stage_info(*options, common); });
}

}  // namespace neuvv::tools
