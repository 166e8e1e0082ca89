// What the files of `neuvv paint` share: its options (paint_options.cpp), what it paints on (painted_scene.cpp): a
// performer by itself, or one that stands on a stage; and how it paints on clips in segments (paint_segments.cpp).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "editor/paint/paint_session.h"
#include "stage/evaluated_stage.h"
#include "tools/command_line.h"
#include "tools/options.h"
#include "voctree/files/clip_index.h"

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
    // Reads what the options name, but for clip and paint. A layer that is to be painted may be missing, and is then
    // added to the performer's list; a layer that is to be read must exist. Throws InputError.
    enum class Use { kPaint, kRead };
    explicit PaintedScene(const PaintOptions& options, Use use = Use::kPaint);

    std::optional<StagedPerformer> staged;  // where the scene is a stage
    Use use;
    std::filesystem::path clip;
    voctree::ClipIndex index;                              // of the clip
    float at = 0;                                          // the frame of the clip that is seen
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // of a clip in segments: around their leaves

    // Then the layer is a folder with a file for each segment.
    bool is_segmented() const { return index.segments.size() > 1; }

    // Keeps a new layer out of the performer's list, because nothing was painted.
    void drop_new_layer();
    // Writes the stage, atomically, where the layer is new in the performer's list. The layer must have been written.
    void save_stage(const PaintOptions& options) const;
};

// A segment of the scene's clip and its paint; a clip that is one file is a segment. Throws InputError.
struct PaintedSegment {
    PaintedSegment(const PaintedScene& scene, const PaintOptions& options, uint32_t number);

    std::filesystem::path layer_file;
    bool is_in_folder;  // the layer's file
    std::shared_ptr<const editor::PaintClip> clip;
    std::shared_ptr<const voctree::EditLayer> layer;  // the one that is painted
    float at = 0;                                     // the frame of the segment that is seen, or is nearest to it
    std::pair<glm::dvec3, glm::dvec3> clip_box;       // around the whole clip's leaves

    // The performer with the visible layers of its list, among them the painted one; without a stage with the painted
    // layer alone.
    editor::PaintSubject subject() const;
    // Writes the layer's file, atomically. Of a clip in segments, the folder is made where it is missing, and a segment
    // without edits has no file.
    void save() const;

  private:
    void read_other_layers(const StagedPerformer& staged, const PaintOptions& options,
                           const voctree::ClipSegment* segment);
    // What is visible beside and of the painted layer, the lowest first; a null layer is the painted one.
    std::vector<editor::VisibleLayer> visible_;
};

// The size of the image whose pixels the options name.
media::ImageSize image_size(const PaintOptions& options, const PaintedScene& scene);
// The camera of the options for an image of this size, in the performer's own space: on a stage, relative to where the
// performer stands there.
stage::Camera camera_of(const PaintOptions& options, const PaintedScene& scene,
                        const std::pair<glm::dvec3, glm::dvec3>& clip_box, media::ImageSize size);

// What layers of paint hold.
struct LayerTotals {
    size_t segments = 0, edits = 0, leaves = 0, colours = 0, densities = 0, erased = 0;
    uint64_t field_leaves = 0;
    void add(const voctree::EditLayer& layer);
};

// A function that paints on a segment at frames of that segment. It returns the layer `before` with what it painted, or
// null where there was no leaf to paint.
using Layer = std::shared_ptr<const voctree::EditLayer>;
using Painting = std::function<Layer(const PaintedSegment&, const Layer& before, const edit::EditFrames&)>;
// How a painting goes on through the segments of a clip.
enum class Spread {
    kEach,     // each segment is painted by itself
    kCarried,  // the segment that is seen is painted; others get the same edits, carried to their leaves
};

// Paints on the segments of a segmented clip, at frames of the clip, and saves each. Returns false where there was no
// leaf to paint. Throws RuntimeFailure where it is stopped: what was painted until then is kept.
bool paint_segments(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
                    Spread spread, const Painting& painting, LayerTotals& totals);
// The numbers of the segments of which the layer has a file; of a clip that is one file, its number.
std::vector<uint32_t> painted_segments(const PaintedScene& scene, const PaintOptions& options);

}  // namespace neuvv::tools
