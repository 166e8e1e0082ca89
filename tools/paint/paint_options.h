// The options of `neuvv paint`, and what they say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/paint/paint_session.h"
#include "tools/command_line.h"
#include "tools/options.h"

namespace neuvv::tools {

struct PaintOptions {
    std::string scene, layer;  // .nvv, .gltf or .glb; .nvpaint
    // Of a stage: the performer, and the time at which it is seen.
    std::string node;
    std::optional<double> time_s;
    // Frames of the clip.
    std::string frames;
    std::optional<double> at;            // nothing: 0; on a stage, the frame that shows at time_s
    std::optional<edit::Follow> follow;  // nothing: Follow::kNot
    bool every_frame = false;
    // The view.
    std::string camera, image, size;  // an empty size: that of the image that `neuvv render` makes
    std::optional<uint32_t> key;
    std::optional<double> orbit_deg;
    // The region.
    std::vector<std::string> boxes, spheres, within_boxes, within_spheres, without_boxes, without_spheres;
    // The brush.
    std::vector<std::string> line;
    double radius_m = 0.03, hardness = 0.7;
    // What the leaves become.
    std::string colour;
    double alpha = 1;
    std::optional<double> density, hue, saturation;
    bool json = false;
};

void add_scene_options(Command paint, PaintOptions& options);
void add_frame_options(Command verb, PaintOptions& options);
Option add_follow_option(Command verb, PaintOptions& options);
void add_camera_options(Command verb, PaintOptions& options);
void add_region_options(Command verb, PaintOptions& options);
void add_alpha_option(Command verb, PaintOptions& options);
void add_density_option(Command verb, PaintOptions& options);
void add_brush_options(Command verb, PaintOptions& options);

// All functions below throw InputError.

// The region inside any of the boxes and spheres (everywhere, where there are none), inside all of those of the
// --within options, and outside all of those of the --without options.
edit::Region region_of(const PaintOptions& options);
// Throws where neither a box nor a sphere is given.
void expect_region(const PaintOptions& options);
// Throws where no option says what the leaves become.
void expect_change(const PaintOptions& options);

// The frames of --frames and --follow; `at` is the frame that is seen.
edit::EditFrames frames_of(const PaintOptions& options, float at, uint32_t clip_frames);

// What --colour, --alpha, --density, --hue and --saturation make of the leaves, at these frames.
editor::PaintOperation operation_of(const PaintOptions& options, const edit::EditFrames& frames);
// The brush, and the region outside which nothing is painted.
editor::PaintArea area_of(const PaintOptions& options);
// The stroke of --line, in pixels.
std::vector<glm::dvec2> line_of(const PaintOptions& options);

// --colour as linear RGB; black where it is not given.
glm::vec3 colour_of(const PaintOptions& options);

}  // namespace neuvv::tools
