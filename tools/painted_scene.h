// What `neuvv paint` paints on: a performer by itself, or one that stands on a stage.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "editor/paint_session.h"
#include "stage/evaluated_stage.h"
#include "tools/options.h"
#include "tools/paint_options.h"

namespace neuvv::tools {

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
