// What painting does to leaves: an operation computes a layer of paint from the layer as it was before and from
// selected leaves.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "edit/brush.h"

namespace neuvv::editor {

// What is painted. The command line, the mouse and the hand all describe it by this struct.
struct PaintOperation {
    enum class Kind {
        kColour,   // paints `colour` with `opacity`, and sets the density to `sigma`
        kErase,    // sets the density to 0
        kShift,    // shifts the field's own colours of each frame, and sets the density to `sigma`
        kRestore,  // removes the layer's edits
    } kind = Kind::kColour;
    glm::vec3 colour{1, 0, 0};  // linear
    float opacity = 1;          // for kColour and kShift; 0: the colours stay
    edit::ColourShift shift;
    float sigma = voctree::kKeepSigma;  // 1/m, for leaves with a share of 1/2 or more; kKeepSigma: the density stays
    edit::EditFrames frames;            // at which the operation applies, for all kinds
};

struct SelectedLeaf {
    uint32_t leaf = 0;
    float share = 1;  // of the leaf that is painted; densities, kErase and kRestore need 1/2 or more
};

// Returns the layer after the operation, or null where nothing changes. `leaves` has each leaf at most once.
std::shared_ptr<const voctree::EditLayer> apply_operation(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                                          std::span<const SelectedLeaf> leaves,
                                                          const PaintOperation& operation);

// The leaves of a region that the operation applies to, each with share 1, in order: those that live at some of the
// frames. kRestore applies to the leaves of which the layer has edits; a density that brings leaves to life applies to
// all leaves.
std::vector<SelectedLeaf> leaves_for(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                     const edit::Region& region, const PaintOperation& operation);

}  // namespace neuvv::editor
