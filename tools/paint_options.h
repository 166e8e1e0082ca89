// What a user tells `neuvv paint`.
#pragma once

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

#include "editor/paint_session.h"

namespace neuvv::tools {

struct PaintOptions {
    std::string scene, layer;  // .nvv, .gltf or .glb; .nvpaint
    // Of a stage: who, and when
    std::string node;
    std::optional<double> time_s;
    // Which frames of the clip
    std::string frames;
    std::optional<double> at;  // without: 0; on a stage, what shows at time_s
    std::string follow = "not";
    bool every_frame = false;
    // From where
    std::string camera, image, size;  // empty: that of the image that `neuvv render` makes
    std::optional<uint32_t> key;
    std::optional<double> orbit_deg;
    // Which leaves
    std::vector<std::string> boxes, spheres, within_boxes, within_spheres, without_boxes, without_spheres;
    // The brush
    std::vector<std::string> line;
    double radius_m = 0.03, hardness = 0.7;
    // What becomes of them
    std::string colour;
    double alpha = 1;
    std::optional<double> density, hue, saturation;
    bool json = false;
};

void add_scene_options(CLI::App& paint, PaintOptions& options);
void add_frame_options(CLI::App& verb, PaintOptions& options);
CLI::Option* add_follow_option(CLI::App& verb, PaintOptions& options);
void add_camera_options(CLI::App& verb, PaintOptions& options);
void add_region_options(CLI::App& verb, PaintOptions& options);
void add_alpha_option(CLI::App& verb, PaintOptions& options);
void add_density_option(CLI::App& verb, PaintOptions& options);
void add_brush_options(CLI::App& verb, PaintOptions& options);

// All that follows throws InputError.

// Any of the boxes and spheres, where there are none everywhere; in all those to be within, in none of those without.
edit::Region region_of(const PaintOptions& options);
// Throws where neither a box nor a sphere is given.
void expect_region(const PaintOptions& options);
// Throws where nothing is said that becomes of the leaves.
void expect_change(const PaintOptions& options);

// The frames of --frames and --follow; `at` is the one that is looked at.
edit::EditFrames frames_of(const PaintOptions& options, float at, uint32_t clip_frames);

// What is painted, at these frames: --colour, --alpha, --density, --hue, --saturation.
editor::PaintOperation operation_of(const PaintOptions& options, const edit::EditFrames& frames);
// The brush, and the region that the verb is kept within.
editor::PaintArea area_of(const PaintOptions& options);
std::vector<glm::dvec2> line_of(const PaintOptions& options);  // pixels

// --colour, linear; black where there is none.
glm::vec3 colour_of(const PaintOptions& options);

}  // namespace neuvv::tools
