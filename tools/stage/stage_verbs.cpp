#include "tools/stage/stage_verbs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/output_path.h"
#include "editor/open_file.h"
#include "media/image.h"
#include "media/sound.h"
#include "motion/skeleton/skeleton_file.h"
#include "stage/stage.h"
#include "tools/options.h"
#include "tools/results.h"
#include "tools/say.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::tools {

namespace {

constexpr double kMaxLength = 1e9, kMaxLux = 1e9;

using Parse = glm::dvec3 (*)(const std::string& option, const std::string& text);

// `names`: of the option, the first of which errors name.
void add_vector_option(Command verb, const std::string& names, std::optional<glm::dvec3>& vector, Parse parse,
                       const std::string& help) {
    const std::string name = names.substr(0, names.find(','));
    verb.add_parsed_option(
        names, [&vector, parse, name](const std::string& text) { vector = parse(name, text); }, help);
}

glm::dvec3 parse_factors(const std::string& option, const std::string& text) {
    if (text.find(',') != std::string::npos) return parse_vector(option, text);
    return glm::dvec3(parse_numbers(option, text, 1, "write a factor, or three: 1,2,1")[0]);
}

glm::dmat4 parse_matrix(const std::string& option, const std::string& text) {
    const std::vector<double> numbers =
        parse_numbers(option, text, 16, "write four columns of four, commas between them");
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = numbers[static_cast<size_t>(i)];
    return matrix;
}

}  // namespace

void add_target(Command verb, StageTarget& target) {
    verb.add_option("STAGE", target.stage, "The stage, .gltf or .glb").required();
    verb.add_option("-o,--output", target.output, "Save it here; default: where it was");
}

void expect_stage_name(const std::string& option, const std::string& file) {
    if (!editor::has_stage_ending(file))
        throw InputError(option, file, "is no name for a stage", "end it in .gltf or .glb");
}

std::function<void()> says_that_it_waits(const std::filesystem::path& file) {
    return [file] { say("{}: waits for another program that edits it\n", file.string()); };
}

void edit_stage(const StageTarget& target, const std::function<std::string(stage::StageFile&)>& operation) {
    const std::string& output = target.output.empty() ? target.stage : target.output;
    if (!target.output.empty()) expect_stage_name("--output", output);
    std::optional<EditLock> lock;
    const bool in_place = stage::absolute_path(output) == stage::absolute_path(target.stage);
    if (in_place) lock.emplace(target.stage, says_that_it_waits(target.stage));
    stage::StageFile file = stage::read_stage_file(target.stage);
    stage::expect_sound_document(file);
    const std::string change = operation(file);
    stage::expect_sound_document(file);
    if (in_place)
        prepare_output_file("STAGE", output);
    else
        prepare_result("--output", output);
    if (in_place) stage::expect_unchanged(file);
    stage::save_stage_file(file, output);
    tell("{}: {}\n", output, change);
}

uint32_t find_performer(const stage::Stage& stage, const std::string& option, const std::string& node) {
    const std::vector<stage::StagePerformer>& all = stage.performers;
    if (node.empty() && all.size() == 1) return 0;
    std::string names;
    for (const stage::StagePerformer& performer : all)
        names += fmt::format("{}{} \"{}\"", names.empty() ? "" : ", ", performer.node, performer.name);
    const std::string fix = all.empty() ? "add one with `neuvv stage add`" : "choose from " + names;
    if (node.empty()) throw InputError(option, "", fmt::format("the stage has {} performers", all.size()), fix);
    const auto is_meant = [&](const stage::StagePerformer& performer) {
        return performer.name == node || std::to_string(performer.node) == node;
    };
    if (std::any_of(all.begin(), all.end(), is_meant)) {
        const uint32_t index = edit::find_node(stage.file, node);
        for (uint32_t i = 0; i < all.size(); ++i)
            if (all[i].node == index) return i;
    }
    throw InputError(option, node, "is no performer of the stage", fix);
}

namespace {

constexpr double kRounding = 1e-5;  // by which a time that was read from a message may be too large

// The stage time after which nothing changes any more; INFINITY where something does for ever.
double last_change_s(const stage::Stage& stage) {
    double last = stage.duration_s;
    for (const stage::StagePerformer& performer : stage.performers)
        last = std::max(last, performer.settings.spin_deg_per_s != 0 ? INFINITY : stage::length_s(performer.timeline));
    for (const stage::GltfAnimation& animation : stage.scene.animations) last = std::max(last, animation.duration_s);
    if (const auto& path = stage.settings.camera_path; path && path->keys.size() > 1)
        last = std::max(last, path->cyclic ? INFINITY : path->duration_s);
    return last;
}

}  // namespace

void expect_time_on_stage(const stage::Stage& stage, const std::string& option, double time_s) {
    const double last_s = last_change_s(stage);
    if (last_s > 0 && time_s > last_s * (1 + kRounding))
        throw InputError(
            option, fmt::format("{:g}", time_s),
            fmt::format("nothing on {} changes after {:.6g} s, when it has ended", stage.file.path.filename().string(),
                        last_s),
            fmt::format("choose 0 to {:.6g}, or let performers loop (`neuvv stage set --time loop`)", last_s));
}

void append_change(std::string& changes, const std::string& change) {
    changes += (changes.empty() ? "" : "; ") + change;
}

glm::dvec3 parse_vector(const std::string& option, const std::string& text) {
    const std::vector<double> numbers = parse_numbers(option, text, 3, "write it as in 1,0,-2.5");
    return {numbers[0], numbers[1], numbers[2]};
}

glm::dvec3 parse_light_colour(const std::string& option, const std::string& text) {
    if (text.find(',') != std::string::npos) return parse_vector(option, text);
    const glm::vec4 colour = parse_colour(option, text);
    if (colour.a < 1) throw InputError(option, text, "is no colour of light", "write black for none");
    return glm::dvec3(glm::vec3(colour));
}

void add_placement_options(Command verb, edit::Placement& placement) {
    add_vector_option(verb, "--at", placement.at, parse_vector,
                      "Where it stands: X,Y,Z in metres, in the space of its parent");
    add_vector_option(verb, "--move", placement.move, parse_vector, "By how much it moves: X,Y,Z");
    add_vector_option(verb, "--turn", placement.turn_deg, parse_vector,
                      "Degrees about the parent's axes, where it stands: X,Y,Z");
    add_vector_option(verb, "--scale", placement.scale, parse_factors, "By which factor, or X,Y,Z along its own axes");
    add_vector_option(verb, "--aim", placement.aim, parse_vector,
                      "The point that its -Z looks at (cameras, lights): X,Y,Z");
    verb.add_parsed_option(
        "--matrix", [&placement](const std::string& text) { placement.matrix = parse_matrix("--matrix", text); },
        "16 numbers by columns, instead of what there was");
}

bool is_given(const edit::Placement& placement) {
    return placement.at || placement.move || placement.turn_deg || placement.scale || placement.aim || placement.matrix;
}

void add_performer_options(Command verb, edit::PerformerEdit& edit) {
    verb.add_parsed_option(
        "--time", [&edit](const std::string& text) { edit.time = stage::parse_time_map(text, "--time", ""); },
        "From stage to clip: operators as in loop:0:2s,speed:0.5,offset:3f; empty: as the clip is");
    verb.add_option("--spin", edit.spin_deg_per_s, "Degrees a second about its own +Y")
        .number_between(-stage::kMaxSpin, stage::kMaxSpin);
    verb.add_option("--opacity", edit.opacity, "0 to 1").number_between(0, 1);
    add_switch(verb, "--visible", edit.visible, "Whether it is seen");
    add_switch(verb, "--casts-shadow", edit.casts_shadow, "Whether it casts shadows");
    add_switch(verb, "--receives-shadow", edit.receives_shadow, "Whether shadows fall on it");
    const auto add_file = [&verb](const char* option, auto& file, const auto& read, const char* help) {
        verb.add_parsed_option(
            option,
            [&file, read](const std::string& given) {
                if (!given.empty()) read(given);  // throws where it is no such file
                file = given;
            },
            help);
    };
    add_file(
        "--skeleton", edit.skeleton, [](const std::string& file) { motion::read_skeleton(file); },
        "Its .skeleton.glb; empty: the file beside its .nvv");
    add_file(
        "--sound", edit.sound, [](const std::string& file) { media::read_sound(voctree::sound_here(file)); },
        "What is heard as its clip plays: a .wav, .flac, .ogg, .mp3, .m4a, or a video with sound, or the address of "
        "one; empty: nothing");
    verb.add_option("--gain", edit.gain_db, "How loud its sound is, dB")
        .number_between(stage::kLeastGain_db, stage::kMostGain_db);
}

void add_stage_options(Command verb, edit::StageEdit& edit) {
    verb.add_option("--duration", edit.duration_s, "Of the stage, seconds").number_between(0, stage::kMaxStageSeconds);
    verb.add_option("--fps", edit.fps, "Of the stage").number_between(stage::kMinStageFps, stage::kMaxStageFps);
    add_vector_option(verb, "--background", edit.background, parse_light_colour,
                      "A colour's name, #rrggbb, or linear R,G,B");
    add_vector_option(verb, "--ambient", edit.ambient, parse_light_colour, "Light on everything: a colour as above");
    const auto set_environment = [&edit](const std::string& file) {
        if (!file.empty()) media::read_png(file);
        edit.environment = file;
    };
    verb.add_parsed_option("--environment", set_environment, "An equirectangular PNG around the stage; empty: none");
    verb.add_option("--environment-intensity", edit.environment_intensity, "Its factor").number_between(0, 1e6);
    verb.add_option("--environment-rotation", edit.environment_rotation_deg, "Its turn about +Y, degrees")
        .number_between(-1e6, 1e6);
    add_choice(verb, "--blend", edit.blend, stage::kStageBlendNames,
               "Of performers: exact, or layer over layer as the paper has it");
    add_switch(verb, "--shadows", edit.shadows, "Whether lights cast shadows");
    add_switch(verb, "--falloff", edit.falloff, "Whether lights shine on performers");
}

void add_light_options(Command verb, edit::LightEdit& edit) {
    verb.add_option("--kind", edit.kind, "spot, point or directional").one_of({"spot", "point", "directional"});
    add_vector_option(verb, "--colour,--color", edit.color, parse_light_colour,
                      "A colour's name, #rrggbb, or linear R,G,B");
    verb.add_option("--intensity", edit.intensity, "Candela; lux of a directional light").number_between(0, kMaxLux);
    verb.add_option("--range", edit.range_m, "Where its light ends, metres").number_between(1e-6, kMaxLength);
    const auto set_cone = [&edit](const std::string& text) {
        const std::vector<double> angles = parse_numbers("--cone", text, 2, "write two half angles, as in 20,30");
        edit.inner_cone_deg = angles[0];
        edit.outer_cone_deg = angles[1];
    };
    verb.add_parsed_option("--cone", set_cone, "Of a spot: half angles of full light and of none, degrees: 20,30");
}

}  // namespace neuvv::tools
