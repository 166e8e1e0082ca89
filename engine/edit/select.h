// What is edited, and which leaves of it: places, densities at a time, regions, and the frames an edit holds at.
#pragma once

#include <functional>
#include <vector>

#include "render/paint.h"
#include "voctree/leaf_density.h"

namespace neuvv::edit {

// A field on the host, with what every tool asks of its leaves. The tree must outlive it.
struct Canvas {
    explicit Canvas(const voctree::VOctree& tree);
    const voctree::VOctree& tree;
    std::vector<glm::vec3> middles;         // per leaf, performer's space, metres
    std::vector<float> edges_m;             // per leaf: the mean of its three edges
    std::vector<voctree::BasisEntry> rows;  // of A
};

// σ of every leaf at a frame (fractions interpolate), 1/m, as painted.
std::vector<float> densities(const Canvas& canvas, float frame, std::span<const render::PaintUse> paint = {});

// A_t and B_t at a frame (fractions interpolate), for leaf after leaf.
struct RowsAtTime {
    RowsAtTime(const voctree::VOctree& tree, float frame);
    std::vector<float> sigma, gamma;
};

// σ of a leaf without paint, 1/m, held at 0; and its mean colour, linear: sigmoid(k_00 Y_00).
float density(const voctree::VOctree& tree, const RowsAtTime& rows, uint32_t leaf);
glm::vec3 mean_colour(const voctree::VOctree& tree, const RowsAtTime& rows, uint32_t leaf);

// Whether a place belongs to it: performer's space, metres.
using Region = std::function<bool(glm::vec3)>;
Region box_region(glm::vec3 low, glm::vec3 high);
Region sphere_region(glm::vec3 middle, float radius_m);
Region either(Region a, Region b);
Region both(Region a, Region b);
Region without(Region a, Region b);

// The leaves whose middles lie in the region and that live at any time from first to last, without paint. With paint
// or before it is there, whether they live or not: all_leaves_in.
std::vector<uint32_t> leaves_in(const Canvas& canvas, const Region& region, float first, float last);
std::vector<uint32_t> all_leaves_in(const Canvas& canvas, const Region& region);

// When edits hold. A leaf stays where it is while the surface moves through it.
enum class Follow {
    kNot,  // from first to last, whatever the leaf shows then
    kRun,  // as long as the leaf is opaque without a break, around first to last: until another surface may come
    kAll,  // whenever the leaf is opaque
};
struct EditFrames {
    float first = 0, last = 0;
    Follow follow = Follow::kNot;
    float opaque = 0.1f;  // a leaf is opaque where its alpha along an edge is more
};

// Each edit at its frames. Runs reach into the fractions before and after them, where the leaf comes and goes; kRun and
// kAll hold from first to last in any case.
std::vector<voctree::LeafEdit> at_frames(const Canvas& canvas, std::span<const voctree::LeafEdit> edits,
                                         const EditFrames& frames);

// Edits that were made at whole frames, or from one to another, reach into the fractions before and after them, where
// the field fades between two frames: to the next frame, or half way where the leaf has an edit there, too; never out
// of first to last. In order of leaf and frame.
std::vector<voctree::LeafEdit> extend_between_frames(std::vector<voctree::LeafEdit> edits, float first, float last);

}  // namespace neuvv::edit
