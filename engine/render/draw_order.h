// Draw order: which instances can be composited one behind the other, and which stand in each other and must be merged.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace neuvv::render {

// A box under an affine transform: middle and half edges, world space, metres.
struct TransformedBox {
    glm::dvec3 middle{0};
    glm::dmat3 half{0};  // columns
};
TransformedBox transformed_box(glm::dvec3 box_min, glm::dvec3 box_max, const glm::dmat4& world_from_box);

// Groups of indices into `boxes`, the first group nearest. Seen from every one of the eyes, along any line, all that is
// inside a group's boxes lies before all that is in later groups'. Within a group there is no such order: boxes
// overlap, or cover each other in a circle, or eyes see them in different orders. A plane between two boxes orders
// them; planes that are parallel to faces or to an edge of each are tried, which finds one wherever there is any.
std::vector<std::vector<uint32_t>> draw_order(std::span<const TransformedBox> boxes, std::span<const glm::dvec3> eyes);

}  // namespace neuvv::render
