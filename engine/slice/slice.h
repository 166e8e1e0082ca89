// A slice: what a clip of any kind shows at one time. Its leaves have a density, and colours that are spherical
// harmonics, and nothing of the bases that these came from.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "shared/hh_counts.h"

namespace neuvv::slice {

// k_lm of each channel; sigmoid(Σ k_lm Y_lm(d)) is linear light (shaders/slice/sh.glsl has Y_lm).
using Colours = std::array<std::array<float, kMaxShCount>, 3>;
constexpr float kMeanHarmonic = 0.28209479f;  // Y_00, the same in all directions

struct Leaf {
    uint64_t cell = 0;   // Morton code of its first cell at the slice's depth
    uint32_t depth = 0;  // octree depth
    float sigma = 0;     // 1/m
    Colours colours{};
    float shown = 0;  // how much of images it makes, m²: its part of the visible area
};

struct Slice {
    glm::vec3 box_min{0}, box_size{1};  // metres
    uint32_t depth = 2;                 // the finest depth that leaves may have
    uint32_t degree = 0;                // of the harmonics
    std::vector<Leaf> leaves;           // in order of their cells; they do not overlap

    glm::vec3 edges_m(const Leaf& leaf) const { return box_size / static_cast<float>(1u << leaf.depth); }
    glm::vec3 centre_m(const Leaf& leaf) const;
    // The mean of its edges, metres; the optical depth and the opacity along it.
    float edge_m(const Leaf& leaf) const;
    float optical_depth(const Leaf& leaf) const { return leaf.sigma * edge_m(leaf); }
    float opacity(const Leaf& leaf) const;
    // How much of images a leaf makes where nothing hides it: its opacity and size.
    float shown_alone(const Leaf& leaf) const { return opacity(leaf) * edge_m(leaf) * edge_m(leaf); }
};

// The mean of the three edges of a cell of this octree depth, metres. `box_size`: of the root, metres.
inline float edge_m(glm::vec3 box_size, uint32_t depth) {
    return (box_size.x + box_size.y + box_size.z) / 3 / static_cast<float>(1u << depth);
}

// The depth of its finest leaves; 1 where there are none.
uint32_t finest_depth(const Slice& slice);

// What is wrong with a slice, or an empty string: leaves that are not in order, overlap, or are finer than its depth;
// a box, depth or degree out of bounds; numbers that are not finite, and densities below 0.
std::string defect_of(const Slice& slice);

// The same slice in other lengths, which shows the same images: p becomes scale · p + shift.
Slice scaled(Slice slice, double scale, const glm::dvec3& shift = glm::dvec3(0));

}  // namespace neuvv::slice
