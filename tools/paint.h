// What the files of `neuvv paint` share: its options (paint_options.cpp), and what it paints on (painted_scene.cpp): a
// performer by itself, or one that stands on a stage.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/paint_session.h"
#include "stage/evaluated_stage.h"
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

// A performer on its stage, at the time at which it is seen.
struct StagedPerformer {
    stage::Stage stage;
    stage::EvaluatedStage evaluated;
    uint32_t index = 0;  // in stage.performers and evaluated.performers
    // Index of the painted layer in the performer's list; the list's size where it is not in the list. A new layer is
    // in the list of `stage` before it is in that of the stage's file.
    size_t layer = 0;
    std::string change;  // what the operation said that added the layer to the list; empty where it was there before

    const stage::StagePerformer& performer() const { return stage.performers[index]; }
    const stage::EvaluatedPerformer& evaluated_performer() const { return evaluated.performers[index]; }
};

struct PaintedScene {
    // Reads all files that the options name. A layer that is to be painted may be missing, and is then added to the
    // performer's list; a layer that is to be read must exist. Throws InputError.
    enum class Use { kPaint, kRead };
    explicit PaintedScene(const PaintOptions& options, Use use = Use::kPaint);

    std::optional<StagedPerformer> staged;  // where the scene is a stage
    std::shared_ptr<const editor::PaintClip> clip;
    std::shared_ptr<const voctree::EditLayer> layer;  // the one that is painted
    float at = 0;                                     // the frame of the clip that is seen

    // The performer with the visible layers of its list, among them the painted one; without a stage with the painted
    // layer alone.
    editor::PaintSubject subject() const;

    // Keeps a new layer out of the performer's list, because nothing was painted.
    void drop_new_layer();
    // Writes the layer's file, and then the stage where the layer is new in the performer's list; each atomically.
    void save(const PaintOptions& options) const;

  private:
    // In the order of the list; null for the painted layer and for those that are not visible.
    std::vector<std::shared_ptr<const voctree::EditLayer>> other_layers_;
};

// The size of the image whose pixels the options name.
media::ImageSize image_size(const PaintOptions& options, const PaintedScene& scene);
// The camera of the options for an image of this size, in the performer's own space: on a stage, relative to where the
// performer stands there.
stage::Camera camera_of(const PaintOptions& options, const PaintedScene& scene, media::ImageSize size);

}  // namespace neuvv::tools
