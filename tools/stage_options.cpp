#include "tools/stage_options.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "tools/commands.h"
#include "tools/options.h"

namespace neuvv::tools {

namespace {

constexpr double kMaxLength = 1e9, kMaxLux = 1e9;

std::optional<glm::dvec3> vector_of(const std::string& option, const std::string& text) {
    if (text.empty()) return {};
    return parse_vector(option, text);
}

std::optional<bool> switch_of(const std::string& text) {
    if (text.empty()) return {};
    return text == "on";
}

CLI::Option* add_switch(CLI::App& verb, const std::string& name, std::string& value, const std::string& help) {
    return verb.add_option(name, value, help + ": on or off")->check(CLI::IsMember({"on", "off"}));
}

}  // namespace

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

edit::Placement PlacementOptions::placement() const {
    edit::Placement placement;
    placement.at = vector_of("--at", at);
    placement.move = vector_of("--move", move);
    placement.turn_deg = vector_of("--turn", turn);
    placement.aim = vector_of("--aim", aim);
    if (!scale.empty())
        placement.scale = scale.find(',') != std::string::npos
                              ? parse_vector("--scale", scale)
                              : glm::dvec3(parse_numbers("--scale", scale, 1, "write a factor, or three: 1,2,1")[0]);
    if (!matrix.empty()) {
        const std::vector<double> numbers =
            parse_numbers("--matrix", matrix, 16, "write four columns of four, commas between them");
        placement.matrix = glm::dmat4(1);
        for (int i = 0; i < 16; ++i) (*placement.matrix)[i / 4][i % 4] = numbers[static_cast<size_t>(i)];
    }
    return placement;
}

void add_placement_options(CLI::App& verb, PlacementOptions& options) {
    verb.add_option("--at", options.at, "Where it stands: X,Y,Z in metres, in the space of its parent");
    verb.add_option("--move", options.move, "By how much it moves: X,Y,Z");
    verb.add_option("--turn", options.turn, "Degrees about the parent's axes, where it stands: X,Y,Z");
    verb.add_option("--scale", options.scale, "By which factor, or X,Y,Z along its own axes");
    verb.add_option("--aim", options.aim, "The point that its -Z looks at (cameras, lights): X,Y,Z");
    verb.add_option("--matrix", options.matrix, "16 numbers by columns, instead of what there was");
}

edit::PerformerEdit PerformerOptions::edit() const {
    edit::PerformerEdit edit;
    if (time) edit.time = stage::parse_time_map(*time, "--time", "");
    edit.spin_deg_per_s = spin;
    edit.opacity = opacity;
    edit.visible = switch_of(visible);
    edit.casts_shadow = switch_of(casts_shadow);
    edit.receives_shadow = switch_of(receives_shadow);
    return edit;
}

void add_performer_options(CLI::App& verb, PerformerOptions& options) {
    verb.add_option("--time", options.time,
                    "From stage to clip: operators as in loop:0:2s,speed:0.5,offset:3f; empty: as the clip is");
    verb.add_option("--spin", options.spin, "Degrees a second about its own +Y")
        ->check(number_between(-stage::kMaxSpin, stage::kMaxSpin));
    verb.add_option("--opacity", options.opacity, "0 to 1")->check(number_between(0, 1));
    add_switch(verb, "--visible", options.visible, "Whether it is seen");
    add_switch(verb, "--casts-shadow", options.casts_shadow, "Whether it casts shadows");
    add_switch(verb, "--receives-shadow", options.receives_shadow, "Whether shadows fall on it");
}

edit::StageEdit StageOptions::edit() const {
    edit::StageEdit edit;
    edit.duration_s = duration;
    edit.fps = fps;
    if (!background.empty()) edit.background = parse_light_colour("--background", background);
    if (!ambient.empty()) edit.ambient = parse_light_colour("--ambient", ambient);
    if (environment) edit.environment = *environment;
    edit.environment_intensity = environment_intensity;
    edit.environment_rotation_deg = environment_rotation;
    if (!blend.empty()) edit.blend = blend == "paper" ? stage::StageBlend::kPaper : stage::StageBlend::kExact;
    edit.shadows = switch_of(shadows);
    edit.falloff = switch_of(falloff);
    return edit;
}

void add_stage_options(CLI::App& verb, StageOptions& options) {
    verb.add_option("--duration", options.duration, "Of the stage, seconds")
        ->check(number_between(0, stage::kMaxStageSeconds));
    verb.add_option("--fps", options.fps, "Of the stage")
        ->check(number_between(stage::kMinStageFps, stage::kMaxStageFps));
    verb.add_option("--background", options.background, "A colour's name, #rrggbb, or linear R,G,B");
    verb.add_option("--ambient", options.ambient, "Light on everything: a colour as above");
    verb.add_option("--environment", options.environment, "An equirectangular PNG around the stage; empty: none");
    verb.add_option("--environment-intensity", options.environment_intensity, "Its factor")
        ->check(number_between(0, 1e6));
    verb.add_option("--environment-rotation", options.environment_rotation, "Its turn about +Y, degrees")
        ->check(number_between(-1e6, 1e6));
    verb.add_option("--blend", options.blend, "Of performers: exact, or layer over layer as the paper has it")
        ->check(CLI::IsMember({"exact", "paper"}));
    add_switch(verb, "--shadows", options.shadows, "Whether lights cast shadows");
    add_switch(verb, "--falloff", options.falloff, "Whether lights shine on performers");
}

edit::LightEdit LightOptions::edit() const {
    edit::LightEdit edit;
    edit.kind = kind;
    edit.intensity = intensity;
    edit.range_m = range;
    if (!color.empty()) edit.color = parse_light_colour("--colour", color);
    if (!cone.empty()) {
        const std::vector<double> angles = parse_numbers("--cone", cone, 2, "write two half angles, as in 20,30");
        edit.inner_cone_deg = angles[0];
        edit.outer_cone_deg = angles[1];
    }
    return edit;
}

void add_light_options(CLI::App& verb, LightOptions& options) {
    verb.add_option("--kind", options.kind, "spot, point or directional")
        ->check(CLI::IsMember({"spot", "point", "directional"}));
    verb.add_option("--colour,--color", options.color, "A colour's name, #rrggbb, or linear R,G,B");
    verb.add_option("--intensity", options.intensity, "Candela; lux of a directional light")
        ->check(number_between(0, kMaxLux));
    verb.add_option("--range", options.range, "Where its light ends, metres")->check(number_between(1e-6, kMaxLength));
    verb.add_option("--cone", options.cone, "Of a spot: half angles of full light and of none, degrees: 20,30");
}

}  // namespace neuvv::tools
