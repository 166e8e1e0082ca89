// What painting does to leaves: an operation takes a layer of paint as it was to the layer as it is then.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "edit/brush.h"

namespace neuvv::editor {

// What is painted. The command line, the mouse and the hand all say it in these words.
struct PaintOperation {
    enum class Kind {
        kColour,   // `colour`, as opaque as `opacity`; and the density `sigma`
        kErase,    // no density
        kShift,    // the field's own colours of each frame, shifted; and the density `sigma`
        kRestore,  // takes the layer's edits out
    } kind = Kind::kColour;
    glm::vec3 colour{1, 0, 0};  // linear
    float opacity = 1;          // of kColour and kShift; 0: the colours stay
    edit::ColourShift shift;
    float sigma = voctree::kKeepSigma;  // 1/m, of leaves that are selected by half or more
    edit::EditFrames frames;            // kShift and kRestore follow the surface as the others do
};

struct SelectedLeaf {
    uint32_t leaf = 0;
    float share = 1;  // how much of it is painted; a density, kErase and kRestore take leaves of a half or more
};

// Each leaf is there at most once. Null where nothing is to be done.
std::shared_ptr<const voctree::EditLayer> apply_operation(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                                          std::span<const SelectedLeaf> leaves,
                                                          const PaintOperation& operation);

// The leaves of a region that the operation is for, whole, in order: those that live at some of the frames; where it
// restores, those that the layer has edits of; where it gives density, which brings leaves to life, all of them.
std::vector<SelectedLeaf> leaves_for(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                     const edit::Region& region, const PaintOperation& operation);

}  // namespace neuvv::editor
