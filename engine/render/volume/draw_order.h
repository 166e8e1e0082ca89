// Draw order: which instances can be composited one behind the other, and which have no such order and must be merged.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace neuvv::render {

// A box under an affine transform, in world space, metres.
struct TransformedBox {
    glm::dvec3 centre{0};
    glm::dmat3 half{0};  // each column is half an edge
};
TransformedBox transformed_box(glm::dvec3 box_min, glm::dvec3 box_max, const glm::dmat4& world_from_box);

// Returns groups of indices into `boxes`, the nearest group first. Along any line from any of the eyes, everything
// inside the boxes of a group lies before everything inside the boxes of later groups. Within a group there is no such
// order: boxes overlap, or cover each other in a circle, or the eyes see them in different orders. Two boxes are
// ordered by a plane between them. The planes that are tried are parallel to a face of one box or to an edge of each,
// which finds a plane wherever there is one (the separating axis theorem).
std::vector<std::vector<uint32_t>> draw_order(std::span<const TransformedBox> boxes, std::span<const glm::dvec3> eyes);

}  // namespace neuvv::render
