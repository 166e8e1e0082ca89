// neuvv stage camera, neuvv stage path.

#include <cmath>
#include <optional>

#include "base/error.h"
#include "interchange/camera/camera_path_file.h"
#include "stage/camera_path_json.h"
#include "stage/evaluated_stage.h"
#include "tools/stage/stage_verbs.h"
#include "tools/view_path.h"

namespace neuvv::tools {

namespace {

constexpr double kDefaultAngle_deg = 45, kMinAngle_deg = 0.1, kMaxAngle_deg = 179;

struct CameraOptions : StageTarget {
    std::optional<std::string> node;
    std::string name;
    bool add = false;
    std::optional<double> angle_deg;
    edit::Placement placement;
};

std::string change_camera(stage::StageFile& file, const CameraOptions& options) {
    if (options.add == options.node.has_value())
        throw InputError("stage camera", options.stage, "needs either a camera's node or --add",
                         "see `neuvv stage camera --help`");
    std::string change;
    if (options.add)
        change = edit::add_camera(file, options.name, glm::radians(options.angle_deg.value_or(kDefaultAngle_deg)),
                                  glm::dmat4(1));
    const uint32_t node =
        options.add ? static_cast<uint32_t>(edit::node_count(file) - 1) : edit::find_node(file, *options.node);
    if (!options.add && options.angle_deg) change = edit::set_camera(file, node, glm::radians(*options.angle_deg));
    if (is_given(options.placement)) append_change(change, edit::place_node(file, node, options.placement));
    if (change.empty()) throw InputError("stage camera", *options.node, "nothing to change", "see --help");
    return change;
}

struct PathOptions : StageTarget {
    std::optional<std::string> from;
    std::optional<stage::Interpolation> interpolation;
    std::optional<bool> cyclic;
    std::optional<double> key_s, to_s, duration_s;
    std::optional<size_t> remove_key, move_key;
    std::string camera;
    bool remove = false;
};

// A key at a time, with the transform and angle of view that the camera of the stage has then.
stage::CameraPathKey key_at(const stage::Stage& stage, const std::string& camera, double time_s) {
    return stage::key_of(stage::camera_of(stage, camera, stage::stage_at(stage, time_s), 2, 2), time_s);
}

// Sets the path, with the options that concern it as a whole.
std::string change_whole_path(stage::StageFile& file, const PathOptions& options,
                              std::optional<stage::CameraPath> path) {
    if (!path) throw InputError("stage path", options.stage, "has no camera path", "begin one with --key");
    path->interpolation = options.interpolation.value_or(path->interpolation);
    path->cyclic = options.cyclic.value_or(path->cyclic);
    path->duration_s = options.duration_s.value_or(path->duration_s);
    return edit::set_camera_path(file, path);
}

std::string change_path(stage::StageFile& file, const PathOptions& options) {
    if (options.remove) return edit::set_camera_path(file, {});
    const stage::Stage stage = stage::make_stage(file);
    const double frame_s = 1 / stage.fps;
    if (options.from)
        return change_whole_path(file, options,
                                 interchange::read_camera_path(*options.from, stage.fps, interchange::frame_of(stage)));
    if (options.key_s) return edit::add_path_key(file, key_at(stage, options.camera, *options.key_s), frame_s);
    if (options.remove_key) return edit::remove_path_key(file, *options.remove_key);
    if (options.move_key) return edit::move_path_key(file, *options.move_key, *options.to_s, frame_s);
    if (!options.interpolation && !options.cyclic && !options.duration_s)
        throw InputError("stage path", options.stage, "nothing to change", "see `neuvv stage path --help`");
    return change_whole_path(file, options, stage.settings.camera_path);
}

}  // namespace

void add_path_verb(Command stage) {
    auto [verb, options] = add_edit_verb(
        stage, "path", "Give a stage a camera path, and change it; `neuvv render --camera path` follows it",
        change_path);
    Command what = verb.add_group("One of these");
    what.add_option(
        "--from", options.from,
        "The path of a file: instant-ngp's, nerfstudio's, a transforms.json, OpenUSD's camera (.usda), or that of a "
        "glTF scene (.glb, .gltf)");
    Option key = what.add_option("--key", options.key_s, "A key at this second of the stage")
                     .number_between(0, stage::kMaxStageSeconds);
    what.add_option("--remove-key", options.remove_key, "Remove the key of this number, from 0");
    Option move = what.add_option("--move-key", options.move_key, "Move the key of this number in time");
    what.add_flag("--remove", options.remove, "Remove the path");
    what.require_options(0, 1);
    verb.add_option("--camera", options.camera, "With --key: as this camera of the stage is then; default: the first")
        .needs(key);
    Option to = verb.add_option("--to", options.to_s, "With --move-key: to this second")
                    .number_between(0, stage::kMaxStageSeconds)
                    .needs(move);
    move.needs(to);
    add_choice(verb, "--interpolation", options.interpolation, stage::kInterpolationNames,
               "Between keys: smooth, linear or cut");
    add_switch(verb, "--cyclic", options.cyclic, "Whether it goes back to its first key, and on");
    verb.add_option("--duration", options.duration_s, "Of a cycle, seconds").number_between(0, stage::kMaxStageSeconds);
    verb.footer(
        {"\n\nExamples, after `neuvv stage new work/show.gltf`:\n"
         "  neuvv stage camera work/show.gltf --add --name left --at -3,1.6,2 --aim 0,1,0\n"
         "  neuvv stage path work/show.gltf --key 0 --camera camera\n"
         "  neuvv stage path work/show.gltf --key 2 --camera left\n"
         "  neuvv stage path work/show.gltf --cyclic on --duration 4"});
}

void add_camera_verb(Command stage) {
    auto [verb, options] = add_edit_verb(stage, "camera", "Add a camera, or change one", change_camera);
    verb.add_option("NODE", options.node, "The camera's name or index");
    Option add = verb.add_flag("--add", options.add, "A new camera");
    verb.add_option("--name", options.name, "Of a new camera's node").needs(add);
    verb.add_option("--angle", options.angle_deg, "Its whole vertical angle of view, degrees; of a new one 45")
        .number_between(kMinAngle_deg, kMaxAngle_deg);
    add_placement_options(verb, options.placement);
    verb.footer(
        {"\n\nExamples, after `neuvv stage new work/show.gltf`:\n"
         "  neuvv stage camera work/show.gltf --add --name left --at -3,1.6,2 --aim 0,1,0\n"
         "  neuvv stage camera work/show.gltf left --angle 30"});
}

}  // namespace neuvv::tools
