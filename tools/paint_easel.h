// What `neuvv paint` paints on: a performer by itself, or one that stands on a stage.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "edit/select.h"
#include "stage/stage_instant.h"
#include "tools/options.h"
#include "tools/paint_options.h"

namespace neuvv::tools {

// A performer on its stage, at the instant that is looked at.
struct StagePlace {
    stage::Stage stage;
    stage::StageInstant instant;
    uint32_t performer = 0;  // of stage.performers and instant.performers
    size_t layer = 0;        // the painted one's place in its list: in `stage`, though it may not be saved yet; the
                             // list's size: it is not there
    std::string change;      // what adding it there said; empty where it lay there before

    const stage::StagePerformer& who() const { return stage.performers[performer]; }
    const stage::InstantPerformer& stands() const { return instant.performers[performer]; }
};

struct Easel {
    // Reads all that the options name. A layer that is to be painted need not be there, nor in the performer's list,
    // yet; one that is to be read must. Throws InputError.
    enum class Use { kPaint, kRead };
    explicit Easel(const PaintOptions& options, Use use = Use::kPaint);

    std::optional<StagePlace> place;  // where the scene is a stage
    voctree::VOctree tree;
    edit::Canvas canvas;
    voctree::EditLayer layer;  // the painted one
    float at = 0;              // the frame that is looked at

    // What the performer looks like: the layers of its list that show, the painted one in its place; that one alone
    // where there is no stage. Pointers into the easel.
    std::vector<render::PaintUse> shown() const;

    // Nothing was painted: what the stage's list would have got it does not get.
    void leave();
    // The layer's file; then the stage, where the layer is new in the performer's list. Atomically, each.
    void save(const PaintOptions& options) const;

  private:
    std::vector<std::unique_ptr<voctree::EditLayer>>
        others_;  // by the list; null for the painted one and what does not show
};

// The size of the picture whose pixels the options name.
PictureSize picture_size(const PaintOptions& options, const Easel& easel);
// The camera of the options in a picture of this size, in the performer's space as it stands on its stage.
stage::Camera camera_of(const PaintOptions& options, const Easel& easel, PictureSize size);

}  // namespace neuvv::tools
