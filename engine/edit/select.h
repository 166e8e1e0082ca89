// Selecting leaves to edit: positions of leaves, their densities at a time, regions, and the frames at which an edit
// applies.
#pragma once

#include <functional>
#include <vector>

#include "render/volume/slices/paint.h"
#include "voctree/temporal_basis.h"

namespace neuvv::edit {

// A field on the host, with what all tools need to know of its leaves. The tree must outlive it.
struct Canvas {
    explicit Canvas(const voctree::VOctree& tree);
    const voctree::VOctree& tree;
    std::vector<glm::vec3> centres;         // of each leaf, in the performer's space, metres
    std::vector<float> edges_m;             // of each leaf: the mean of its three edges
    std::vector<voctree::BasisEntry> rows;  // the rows of A
};

// σ of every leaf at a frame, in 1/m, with paint; between two frames it is interpolated.
std::vector<float> densities(const Canvas& canvas, float frame, std::span<const render::PaintUse> paint = {});

// σ of a leaf without paint, in 1/m, at least 0; and its mean colour, linear: sigmoid(k_00 Y_00).
float density(const voctree::VOctree& tree, const voctree::RowsAtTime& rows, uint32_t leaf);
glm::vec3 mean_colour(const voctree::VOctree& tree, const voctree::RowsAtTime& rows, uint32_t leaf);

// Whether a point belongs to the region: performer's space, metres.
using Region = std::function<bool(glm::vec3)>;
Region box_region(glm::vec3 low, glm::vec3 high);
Region sphere_region(glm::vec3 centre, float radius_m);
Region either(Region a, Region b);
Region both(Region a, Region b);
Region without(Region a, Region b);

// leaves_in: the leaves whose centres lie in the region and that live, without paint, at any time from frame `first` to
// frame `last`. all_leaves_in: all leaves whose centres lie in the region, whether they live or not.
std::vector<uint32_t> leaves_in(const Canvas& canvas, const Region& region, float first, float last);
std::vector<uint32_t> all_leaves_in(const Canvas& canvas, const Region& region);

// When edits apply, given that a leaf stays where it is while the surface moves through it.
enum class Follow {
    kNot,  // from first to last, whatever the leaf shows then
    kRun,  // while the leaf is opaque without a break around first to last, so that another surface is not painted
    kAll,  // whenever the leaf is opaque
};
struct EditFrames {
    float first = 0, last = 0;  // none where first > last: then kAll alone applies at any frames
    Follow follow = Follow::kNot;
    float opaque = 0.1f;  // a leaf is opaque where its alpha along an edge is larger than this
};

// Gives the edits their frames; an edit may become several. With kRun and kAll the range extends into the fractions of
// a frame before and after, in which the leaf appears and vanishes, and covers `first` to `last` in any case. The
// result is in the order of the edits.
std::vector<voctree::LeafEdit> at_frames(const Canvas& canvas, std::span<const voctree::LeafEdit> edits,
                                         const EditFrames& frames);

// The edits of leaves that are opaque at a whole frame, with the frames at which such a leaf stays opaque around it.
std::vector<voctree::LeafEdit> in_runs(const Canvas& canvas, std::span<const voctree::LeafEdit> edits, float frame,
                                       float opaque = EditFrames{}.opaque);

// Extends edits of whole frames, or from one frame to another, into the fractions before and after, in which the field
// fades between two frames: up to the next frame, or half way where the leaf has an edit there, too, but never beyond
// `first` and `last`. The result is in order of leaf and frame.
std::vector<voctree::LeafEdit> extend_between_frames(std::vector<voctree::LeafEdit> edits, float first, float last);

}  // namespace neuvv::edit
