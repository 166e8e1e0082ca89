// One frame of a clip as leaves that other formats are made of.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "voctree/frame_leaves.h"

namespace neuvv::interchange {

struct VolumeLeaf {
    uint64_t cell = 0;             // Morton code of its first cell at the volume's depth
    uint32_t depth = 0;            // octree depth
    float sigma = 0;               // 1/m
    voctree::LeafColours colours;  // sigmoid(Σ k_lm Y_lm(d)) is linear light (shaders/slice/sh.glsl has Y_lm)
    float shown = 0;               // how much of images it makes, m²: its part of the visible area
};

struct FrameVolume {
    glm::vec3 box_min{0}, box_size{1};  // metres
    uint32_t depth = 2;                 // the finest depth that leaves may have
    uint32_t degree = 0;                // of the harmonics
    std::vector<VolumeLeaf> leaves;     // in order of their cells; they do not overlap

    glm::vec3 edges_m(const VolumeLeaf& leaf) const { return box_size / static_cast<float>(1u << leaf.depth); }
    glm::vec3 centre_m(const VolumeLeaf& leaf) const;
    // The mean of its edges, metres; the optical depth along it.
    float edge_m(const VolumeLeaf& leaf) const;
    float optical_depth(const VolumeLeaf& leaf) const { return leaf.sigma * edge_m(leaf); }
};

// What a tree shows at a frame, or between two, under layers of paint, the lowest first: its leaves whose opacity along
// their edge is at least a thousandth. Each counts as shown by its opacity and size, as if nothing hid it.
FrameVolume frame_volume(const voctree::VOctree& tree, double frame, std::span<const voctree::PaintStep> paint = {});

// The same volume in other lengths, which shows the same images: p becomes scale · p + shift.
FrameVolume scaled(FrameVolume volume, double scale, const glm::dvec3& shift = glm::dvec3(0));

// The same volume with at most `most_leaves` leaves, or eight where that is less: cells of the finest depth become one,
// those first of which images show least difference. What they hide and show together stays about the same.
FrameVolume with_fewer_leaves(FrameVolume volume, size_t most_leaves);

// The same volume without leaves below a depth, which becomes its finest.
FrameVolume with_depth(FrameVolume volume, uint32_t most_depth);

}  // namespace neuvv::interchange
