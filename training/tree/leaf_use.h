// How rays used each leaf since the tree last changed. Growth decides by it.
#pragma once

#include <cstdint>
#include <vector>

namespace neuvv::training {

struct LeafUse {
    std::vector<float> max_weight;           // the largest blending weight of its samples
    std::vector<float> opacity_sensitivity;  // Σ |α ∂L/∂α| over its samples
    std::vector<uint32_t> frames;  // a bit for each frame that used it: a word per 32 frames and leaf, leaves fastest
};

}  // namespace neuvv::training
