// neuvv stage: makes stages and changes them. Each verb calls operations of engine/edit.
#include <fmt/format.h>

#include "base/error.h"
#include "base/output_path.h"
#include "shared/lights.h"
#include "stage/stage.h"
#include "tools/options.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "tools/stage/stage_verbs.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::tools {

namespace {

// Throws InputError where parts of the time map do not lie in the clip. A clip may be missing; then they are not
// checked.
void expect_fitting_time(const stage::TimeMap& time, const std::filesystem::path& clip) {
    std::error_code error;
    if (!stream::is_address(clip) && !std::filesystem::exists(clip, error)) return;
    const voctree::ClipHeader header = voctree::read_clip_header(clip);
    const std::string text = stage::text_of(time);
    stage::expect_parts_within(stage::timeline_of(time, header.frames, static_cast<double>(header.fps), "--time", text),
                               "--time", text);
}

// Throws InputError where a layer is not one of this clip. Of a clip in segments, the first that is painted is read.
void expect_layer_of(const std::filesystem::path& clip, const std::filesystem::path& layer) {
    voctree::expect_no_stream(clip);
    const voctree::ClipIndex index = voctree::read_clip_index(clip);
    if (index.segments.size() == 1) {
        voctree::read_paint(layer, voctree::painted_field(voctree::read_segment(index.segments[0])));
        return;
    }
    voctree::expect_paint_folder(layer);
    for (const voctree::ClipSegment& segment : index.segments) {
        const std::filesystem::path file = voctree::paint_file(layer, segment);
        std::error_code error;
        if (!std::filesystem::exists(file, error)) continue;
        voctree::read_paint(file, voctree::painted_field(voctree::read_segment(segment)));
        return;
    }
    throw InputError(layer.string(), "", "has no paint for any segment of the clip",
                     "name a folder that `neuvv paint` made for this clip");
}

// Throws InputError where the layer is not one of the performer's clip, which would otherwise be noticed only when the
// stage is rendered. A clip may be missing; then the layer is not checked.
void expect_fitting_paint(const stage::StageFile& file, uint32_t node, const std::string& performer,
                          const std::filesystem::path& layer) {
    const std::filesystem::path clip = edit::clip_of(file, node);
    std::error_code error;
    if (!stream::is_address(clip) && !std::filesystem::exists(clip, error)) return;
    try {
        expect_layer_of(clip, layer);
    } catch (const InputError& problem) {
        throw InputError(file.path.string(), fmt::format("\"{}\", which plays {}", performer, clip.filename().string()),
                         message_of(problem));
    }
}

void add_new(Command stage) {
    Command verb = stage.add_verb("new", "Make a stage: a floor, a camera, a spotlight");
    const auto output = std::make_shared<std::string>();
    verb.add_option("STAGE", *output, "The stage to make, .gltf or .glb").required();
    verb.footer({"\n\nExamples:\n  neuvv stage new work/show.gltf"});
    verb.callback([output] {
        expect_stage_name("STAGE", *output);
        prepare_result("STAGE", *output);
        const EditLock lock(*output, says_that_it_waits(*output));
        prepare_result("STAGE", *output);  // what another program made meanwhile stays
        stage::StageFile file = edit::new_stage(*output);
        stage::save_stage_file(file, *output);
        tell("{}: a floor, \"camera\" and the spotlight \"key\"\n", *output);
    });
}

struct AddOptions : StageTarget {
    std::string clip, name;
    edit::Placement placement;
    edit::PerformerEdit performer;
    std::optional<voctree::UpAxis> up;
};

// A stage takes every PlenOctree to have +Z up, so one with +Y up is turned by its node.
void place_upright(const AddOptions& options, edit::Placement& placement) {
    if (up_of(options.clip, options.up) == voctree::UpAxis::kZ) return;
    if (placement.turn_deg)
        throw InputError("--up", "y", "turns the performer by 90,0,0, and --turn turns it, too", "give --turn alone");
    placement.turn_deg = {90, 0, 0};
}

std::string add_performer(stage::StageFile& file, const AddOptions& options) {
    const std::filesystem::path clip = voctree::clip_path(options.clip);
    voctree::read_clip_header(clip);
    edit::PerformerEdit performer = options.performer;
    performer.clip = clip;
    if (performer.time) expect_fitting_time(*performer.time, clip);
    edit::Placement placement = options.placement;
    place_upright(options, placement);
    return edit::add_performer(file, options.name, performer, placement);
}

void add_add(Command stage) {
    auto [verb, options] = add_edit_verb(stage, "add", "Put a performer on a stage", add_performer);
    verb.add_option("CLIP", options.clip,
                    "The .nvv or .nvs that it plays, the .npz of a PlenOctree, or the address of a .nvs")
        .required();
    verb.add_option("--name", options.name, "Its node's; default: the file's");
    add_placement_options(verb, options.placement);
    add_up_option(verb, options.up);
    add_performer_options(verb, options.performer);
    verb.footer({kExamplesHead,
                 "  neuvv stage new work/show.gltf\n"
                 "  neuvv stage add work/show.gltf work/performer.nvv --name anna --at 0,0,0\n"
                 "  neuvv stage add work/show.gltf work/performer.nvv --name berta --at 1,0,0 --time loop,speed:0.5"});
}

struct SetOptions : StageTarget {
    std::optional<std::string> node, name;
    std::optional<bool> shown, locked;
    edit::Placement placement;
    edit::PerformerEdit performer;
    edit::StageEdit whole;
};

std::string set_node(stage::StageFile& file, const SetOptions& options) {
    const uint32_t node = edit::find_node(file, *options.node);
    const edit::PerformerEdit& performer = options.performer;
    if (performer.clip) voctree::read_clip_header(*performer.clip);
    if (performer.time)
        expect_fitting_time(*performer.time, performer.clip ? *performer.clip : edit::clip_of(file, node));
    const bool of_performer = performer.clip || performer.time || performer.spin_deg_per_s || performer.opacity ||
                              performer.visible || performer.casts_shadow || performer.receives_shadow ||
                              performer.skeleton || performer.sound || performer.gain_db;
    std::string change;
    if (options.name) append_change(change, edit::rename_node(file, node, *options.name));
    if (is_given(options.placement)) append_change(change, edit::place_node(file, node, options.placement));
    if (options.shown) append_change(change, edit::show_node(file, node, *options.shown));
    if (options.locked) append_change(change, edit::lock_node(file, node, *options.locked));
    if (of_performer) append_change(change, edit::set_performer(file, node, performer));
    if (change.empty()) throw InputError("stage set", *options.node, "nothing to change", "see --help");
    return change;
}

void add_set(Command stage) {
    Command verb = stage.add_verb("set", "Change a node of a stage, or the stage itself");
    const auto options = std::make_shared<SetOptions>();
    add_target(verb, *options);
    verb.add_option("NODE", options->node, "Its name or index; without: the stage");
    Command node = verb.add_group("Of a node");
    node.add_option("--name", options->name, "A new name");
    add_switch(node, "--shown", options->shown, "Whether it is seen, with all that hangs on it, cameras aside");
    add_switch(node, "--locked", options->locked, "Whether programs keep hands from moving it");
    add_placement_options(node, options->placement);
    Command performer = verb.add_group("Of a performer");
    performer.add_parsed_option(
        "--clip", [&edit = options->performer](const std::string& clip) { edit.clip = voctree::clip_path(clip); },
        "Another .nvv");
    add_performer_options(performer, options->performer);
    Command whole = verb.add_group("Of the stage");
    add_stage_options(whole, options->whole);
    verb.footer(
        {"\n\nExamples, after those of `neuvv stage add --help`:\n"
         "  neuvv stage set work/show.gltf anna --turn 0,90,0 --spin 30\n"
         "  neuvv stage set work/show.gltf anna --time loop:0:1s,offset:3f --opacity 0.5\n"
         "  neuvv stage set work/show.gltf --duration 6 --ambient 0.1,0.1,0.15"});
    verb.callback([options, node, performer, whole] {
        const bool names_node = options->node.has_value();
        if (names_node && whole.count_all() > 0)
            throw InputError("stage set", *options->node, "a node has no options of the stage",
                             "leave the node out, or set them one after the other");
        if (!names_node && node.count_all() + performer.count_all() > 0)
            throw InputError("stage set", options->stage, "these options are a node's", "name the node");
        edit_stage(*options, [&](stage::StageFile& file) {
            return names_node ? set_node(file, *options) : edit::set_stage(file, options->whole);
        });
    });
}

struct DuplicateOptions : StageTarget {
    std::string node, stagger = "0";
    int64_t count = 1;
    std::optional<double> row, ring;
    std::vector<double> fan;
    double spin_step = 0;
};

std::string duplicate_node(stage::StageFile& file, const DuplicateOptions& options) {
    edit::CopySettings settings;
    settings.count = static_cast<uint32_t>(options.count);
    settings.stagger = stage::parse_clip_time(options.stagger, "--stagger", "");
    settings.spin_step = options.spin_step;
    if (options.ring) settings.pattern = edit::CopyPattern::kRing;
    if (!options.fan.empty()) {
        settings.pattern = edit::CopyPattern::kFan;
        settings.arc_deg = options.fan[1];
        if (options.fan[0] == 0)
            throw InputError("--fan", "0", "is no radius: all would stand in each other", "give it some metres");
    }
    settings.distance_m = options.row ? *options.row : options.ring ? *options.ring : options.fan[0];
    const size_t before = edit::node_count(file);
    const std::string done = edit::duplicate_node(file, edit::find_node(file, options.node), settings);
    return fmt::format("{}, nodes {} to {}", done, before, edit::node_count(file) - 1);
}

void add_duplicate(Command stage) {
    auto [verb, options] =
        add_edit_verb(stage, "duplicate", "Copies of a node in a row, a ring or a fan, each later", duplicate_node);
    verb.add_option("NODE", options.node, "Its name or index").required();
    verb.add_option("--count", options.count, "Copies, besides the node itself")
        .in_range(int64_t{1}, int64_t{edit::kMaxCopies})
        .show_default();
    Command pattern = verb.add_group("How they stand");
    pattern.add_option("--row", options.row, "One beside the other along +X, so many metres apart")
        .number_between(-1e6, 1e6);
    pattern.add_option("--ring", options.ring, "On a circle of this radius, facing outward").number_between(1e-3, 1e6);
    pattern.add_option("--fan", options.fan, "On an arc of such a circle: radius, degrees")
        .expected(2)
        .number_between(-1e6, 1e6);
    pattern.require_options(1, 1);
    verb.add_option("--stagger", options.stagger,
                    "Each is so much behind the one before: 3f, frames of the clip, or 0.5s. What loops runs "
                    "from the start on; what does not starts so much later, and the stage becomes longer")
        .show_default();
    verb.add_option("--spin-step", options.spin_step, "Each spins so much faster, degrees a second")
        .number_between(-stage::kMaxSpin, stage::kMaxSpin);
    verb.footer(
        {"\n\nExamples, after those of `neuvv stage add --help`:\n"
         "  neuvv stage duplicate work/show.gltf anna --count 5 --ring 2 --stagger 4f\n"
         "  neuvv stage duplicate work/show.gltf berta --count 3 --row 0.8 --spin-step 45"});
}

struct RemoveOptions : StageTarget {
    std::string node;
};

std::string remove_node(stage::StageFile& file, const RemoveOptions& options) {
    return edit::remove_node(file, edit::find_node(file, options.node));
}

void add_remove(Command stage) {
    auto [verb, options] =
        add_edit_verb(stage, "remove", "Take a node off, what hangs on it, and what only it used", remove_node);
    verb.add_option("NODE", options.node, "Its name or index").required();
    verb.footer(
        {"\n\nExamples, after those of `neuvv stage add --help`:\n"
         "  neuvv stage remove work/show.gltf berta"});
}

struct LightOptions : StageTarget {
    std::optional<std::string> node;
    std::string name;
    bool add = false, remove = false;
    edit::Placement placement;
    edit::LightEdit light;
};

std::string change_light(stage::StageFile& file, const LightOptions& options) {
    if (options.add == options.node.has_value() || (options.add && options.remove))
        throw InputError("stage light", options.stage, "needs either a light's node or --add",
                         "see `neuvv stage light --help`");
    if (options.add) return edit::add_light(file, options.name, options.light, options.placement);
    const uint32_t node = edit::find_node(file, *options.node);
    if (options.remove) return edit::remove_light(file, node);
    std::string change = edit::set_light(file, node, options.light);
    if (is_given(options.placement)) append_change(change, edit::place_node(file, node, options.placement));
    return change;
}

void add_light_verb(Command stage) {
    auto [verb, options] = add_edit_verb(
        stage, "light",
        fmt::format("Add a light, change it or take it off. The first {} of a stage shine; the first {} spots "
                    "and directional lights of them cast shadows, points none",
                    kMaxSetLights, kMaxShadows),
        change_light);
    verb.add_option("NODE", options.node, "The light's name or index");
    Option add = verb.add_flag("--add", options.add, "A new light");
    verb.add_flag("--remove", options.remove, "No light any more").excludes(add);
    verb.add_option("--name", options.name, "Of a new light's node").needs(add);
    add_placement_options(verb, options.placement);
    add_light_options(verb, options.light);
    verb.footer(
        {"\n\nExamples, after `neuvv stage new work/show.gltf`:\n"
         "  neuvv stage light work/show.gltf --add --name back --at -2,3,-2 --aim 0,1,0 --colour '#ffd0a0'\n"
         "  neuvv stage light work/show.gltf key --intensity 80 --cone 15,25\n"
         "  neuvv stage light work/show.gltf back --remove"});
}

struct PaintListOptions : StageTarget {
    std::string node;
    std::optional<std::string> add;
    std::optional<size_t> layer, to;
    edit::PaintEdit edit;
    bool remove = false;
};

std::string change_paint(stage::StageFile& file, const PaintListOptions& options) {
    const uint32_t node = edit::find_node(file, options.node);
    if (options.add.has_value() == options.layer.has_value())
        throw InputError("stage paint", options.stage, "needs either --add or --layer",
                         "see `neuvv stage paint --help`");
    if (options.add) {
        expect_fitting_paint(file, node, options.node, *options.add);
        return edit::add_paint_layer(file, node, *options.add, options.edit);
    }
    if (options.remove) return edit::remove_paint_layer(file, node, *options.layer);
    const std::string change = edit::set_paint_layer(file, node, *options.layer, options.edit);
    return options.to ? edit::move_paint_layer(file, node, *options.layer, *options.to) : change;
}

void add_paint(Command stage) {
    auto [verb, options] = add_edit_verb(stage, "paint", "Change the list of a performer's paint layers", change_paint);
    verb.add_option("NODE", options.node, "The performer's name or index").required();
    verb.add_option("--add", options.add, "A .nvpaint that becomes the uppermost layer");
    Option layer = verb.add_option("--layer", options.layer, "The layer to change; 0 is the lowest");
    verb.add_flag("--remove", options.remove, "Not a layer any more; its file stays").needs(layer);
    verb.add_option("--to", options.to, "Where in the list it goes").needs(layer);
    verb.add_option("--name", options.edit.name, "Its name");
    verb.add_option("--opacity", options.edit.opacity, "0 to 1").number_between(0, 1);
    add_switch(verb, "--visible", options.edit.visible, "Whether it is seen");
    add_choice(verb, "--blend", options.edit.blend, stage::kPaintBlendNames,
               "How its colours go over what is below. normal: in their place; multiply: times them, as a filter; "
               "tint: times them, but as bright as before, as if lit by them; recolour: their hue and saturation, "
               "as bright as before");
    verb.footer(
        {"\n\nExamples, where work/red.nvpaint is a layer of the performer `anna`:\n"
         "  neuvv stage paint work/show.gltf anna --add work/red.nvpaint --name red --blend tint\n"
         "  neuvv stage paint work/show.gltf anna --layer 0 --opacity 0.5"});
}

}  // namespace

void add_stage(Command app, CommonOptions& common) {
    Command verb = app.add_verb("stage", "Make a stage for performers, and change what is on it");
    verb.require_verb();
    add_new(verb);
    add_add(verb);
    add_set(verb);
    add_duplicate(verb);
    add_remove(verb);
    add_light_verb(verb);
    add_camera_verb(verb);
    add_path_verb(verb);
    add_paint(verb);
    add_stage_info(verb, common);
    verb.footer({kExamplesHead,
                 "  neuvv stage new work/show.gltf\n"
                 "  neuvv stage add work/show.gltf work/performer.nvv --name anna --time loop\n"
                 "  neuvv stage duplicate work/show.gltf anna --count 5 --ring 2 --stagger 4f\n"
                 "  neuvv stage info work/show.gltf"});
}

}  // namespace neuvv::tools
