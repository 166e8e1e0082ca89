// Options that the verbs of `neuvv stage` share, as values.
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

#include "edit/operations.h"

namespace neuvv::tools {

// "X,Y,Z"; throws InputError naming the option.
glm::dvec3 parse_vector(const std::string& option, const std::string& text);
// "R,G,B" linear, or an sRGB colour by name or #rrggbb.
glm::dvec3 parse_light_colour(const std::string& option, const std::string& text);

// As written; empty where not given.
struct PlacementOptions {
    std::string at, move, turn, scale, matrix, aim;
    edit::Placement placement() const;
    bool any() const { return !(at + move + turn + scale + matrix + aim).empty(); }
};
void add_placement_options(CLI::App& verb, PlacementOptions& options);

struct PerformerOptions {
    std::optional<std::string> time;
    std::optional<double> spin, opacity;
    std::string visible, casts_shadow, receives_shadow;  // "on", "off" or empty
    edit::PerformerEdit edit() const;
};
void add_performer_options(CLI::App& verb, PerformerOptions& options);

struct StageOptions {
    std::optional<double> duration, fps, environment_intensity, environment_rotation;
    std::string background, ambient, blend, shadows, falloff;
    std::optional<std::string> environment;
    edit::StageEdit edit() const;
};
void add_stage_options(CLI::App& verb, StageOptions& options);

struct LightOptions {
    std::optional<std::string> kind;
    std::string color, cone;
    std::optional<double> intensity, range;
    edit::LightEdit edit() const;
};
void add_light_options(CLI::App& verb, LightOptions& options);

}  // namespace neuvv::tools
