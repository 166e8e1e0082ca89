// Blocks of an image, each of which is drawn as an image of its own.
#pragma once

#include "stage/camera.h"

namespace neuvv::editor {

struct Block {
    uint32_t left = 0, top = 0;  // pixels of the image
    stage::Camera camera;        // has the block's size and casts the same rays as the image's camera
};

// Block i of a grid of side × side blocks, counted row by row. Together the blocks cover each pixel of the image once.
inline Block block_of(stage::Camera camera, uint32_t i, uint32_t side) {
    const auto part = [side](uint32_t whole, uint32_t n) { return static_cast<uint32_t>(uint64_t{whole} * n / side); };
    Block block{part(camera.width, i % side), part(camera.height, i / side), camera};
    block.camera.width = part(camera.width, i % side + 1) - block.left;
    block.camera.height = part(camera.height, i / side + 1) - block.top;
    block.camera.cx -= block.left;
    block.camera.cy -= block.top;
    return block;
}

// The smallest side of a grid whose blocks have no more than width × height pixels.
inline uint32_t min_grid_side(const stage::Camera& camera, uint32_t width, uint32_t height) {
    uint32_t side = 1;
    while ((camera.width + side - 1) / side > width || (camera.height + side - 1) / side > height) ++side;
    return side;
}

}  // namespace neuvv::editor
