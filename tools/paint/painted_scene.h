// What `neuvv paint` paints on: a performer by itself, or one that stands on a stage, segment by segment.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "editor/paint/paint_session.h"
#include "stage/evaluated_stage.h"
#include "tools/paint/paint_options.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

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

}  // namespace neuvv::tools
