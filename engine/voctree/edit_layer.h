// A layer of paint on a field: edits that change the colour or density of leaves during some frames (errata 14). Layers
// are stored beside the field's weights, so that performers that share a field can be painted differently. A layer's
// blend and opacity belong to the performer that uses it (stage/performer_settings.h).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Identifies the field that paint was made for.
struct PaintedField {
    uint64_t topology = 0;  // XXH3-64 of levels, nodes and children
    uint32_t leaf_count = 0;
    uint32_t frames = 1;
    bool operator==(const PaintedField&) const = default;
};
PaintedField painted_field(const VOctree& tree);

constexpr float kKeepSigma = -1;

struct LeafEdit {
    uint32_t leaf = 0;
    float first = 0, last = 0;  // frames: the edit applies where first <= t <= last
    glm::vec3 colour{0};        // target colour, linear RGB of 0 to 1
    float alpha = 0;            // weight of the target colour, 0 to 1; 0: the colour stays
    float sigma = kKeepSigma;   // target density, 1/m; 0 erases the leaf; kKeepSigma: the density stays
    bool operator==(const LeafEdit&) const = default;
};

// Edits are in order of leaf, then of first frame, and no two edits of a leaf apply at the same time.
struct EditLayer {
    PaintedField field;
    std::vector<LeafEdit> edits;
};
// Layers by the absolute path of the .nvpaint that holds them. Of a layer on a clip in segments, each segment's file is
// one of its own (paint_file of nvpaint.h). A layer is never changed in place: painting replaces it.
using PaintLayers = std::map<std::filesystem::path, std::shared_ptr<const EditLayer>>;
// Those of a layer of a performer, whose path is that of the file, or that of the folder in which the files are.
PaintLayers files_of_layer(const PaintLayers& layers, const std::filesystem::path& layer);

// Adds edits over those of the layer, each over those before it. Where two edits apply at the same time, the upper
// one's colour is composited over the lower one's by its alpha (1 replaces it), and its density, where it has one,
// replaces the lower one's. At other times the lower edit stays. The new edits may be in any order and overlap;
// otherwise they must be valid (defect_of).
void add_edits(EditLayer& layer, std::span<const LeafEdit> edits);

// Removes what applies to these leaves (in any order) from frame `first` to frame `last`, both included.
void remove_edits(EditLayer& layer, std::span<const uint32_t> leaves, float first, float last);

// What is wrong with a layer, or an empty string: numbers out of range, edits out of order or overlapping in time.
std::string defect_of(const EditLayer& layer);

}  // namespace neuvv::voctree
