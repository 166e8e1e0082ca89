// What a tool does to chosen leaves: a layer of paint as it was → as it is then.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "edit/brush.h"

namespace neuvv::viewer {

struct PaintWork {
    enum class Kind {
        kColour,   // `colour`, as opaque as `opacity`
        kErase,    // no density
        kShift,    // the field's own colours of each frame, shifted
        kRestore,  // takes the layer's edits out
    } kind = Kind::kColour;
    glm::vec3 colour{1, 0, 0};  // linear
    float opacity = 1;          // of kColour and kShift
    edit::ColourShift shift;
    edit::EditFrames frames;  // kShift and kRestore follow the surface as the others do
};

struct ChosenLeaf {
    uint32_t leaf = 0;
    float share = 1;  // how much of it is painted; kErase and kRestore take those of a half or more
};

// Each leaf at most once. Null where nothing is to be done.
std::shared_ptr<const voctree::EditLayer> worked_on(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                                    std::span<const ChosenLeaf> leaves, const PaintWork& work);

// Those of a region that the work is for, whole: what is there at some of the frames; where it restores, what the
// layer has edits of.
std::vector<ChosenLeaf> chosen_in(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                  const edit::Region& region, const PaintWork& work);

}  // namespace neuvv::viewer
