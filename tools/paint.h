// What the files of `neuvv paint` share: its options (paint_options.cpp), and what it paints on (painted_scene.cpp): a
// performer by itself, or one that stands on a stage.
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/paint_session.h"
#include "stage/evaluated_stage.h"
#include "tools/options.h"

namespace neuvv::tools {

struct PaintOptions {
    std::string scene, layer;  // .nvv, .gltf or .glb; .nvpaint
    // Of a stage: who, and when
    std::string node;
    std::optional<double> time_s;
    // Which frames of the clip
    std::string frames;
    std::optional<double> at;            // without: 0; on a stage, what shows at time_s
    std::optional<edit::Follow> follow;  // without: not
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

// A performer on its stage, at the time that is looked at.
struct StagedPerformer {
    stage::Stage stage;
    stage::EvaluatedStage evaluated;
    uint32_t performer = 0;  // of stage.performers and time.performers
    size_t layer = 0;        // the painted one's index in its list: in `stage`, though it may not be saved yet; the
                             // list's size: it is not there
    std::string change;      // what adding it there said; empty where it lay there before

    const stage::StagePerformer& who() const { return stage.performers[performer]; }
    const stage::EvaluatedPerformer& stands() const { return evaluated.performers[performer]; }
};

struct PaintedScene {
    // Reads all that the options name. A layer that is to be painted need not be there, nor in the performer's list,
    // yet; one that is to be read must. Throws InputError.
    enum class Use { kPaint, kRead };
    explicit PaintedScene(const PaintOptions& options, Use use = Use::kPaint);

    std::optional<StagedPerformer> staged;  // where the scene is a stage
    std::shared_ptr<const editor::PaintClip> clip;
    std::shared_ptr<const voctree::EditLayer> layer;  // the painted one
    float at = 0;                                     // the frame that is looked at

    // The performer as it looks: the layers of its list that show, the painted one among them; that one alone where
    // there is no stage.
    editor::PaintSubject subject() const;

    // Nothing was painted: what the stage's list would have got it does not get.
    void leave();
    // The layer's file; then the stage, where the layer is new in the performer's list. Atomically, each.
    void save(const PaintOptions& options) const;

  private:
    // By the list; null for the painted one and what does not show.
    std::vector<std::shared_ptr<const voctree::EditLayer>> others_;
};

// The size of the image whose pixels the options name.
media::ImageSize image_size(const PaintOptions& options, const PaintedScene& scene);
// The camera of the options in an image of this size, in the performer's space as it stands on its stage.
stage::Camera camera_of(const PaintOptions& options, const PaintedScene& scene, media::ImageSize size);

}  // namespace neuvv::tools
