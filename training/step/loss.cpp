#include "training/step/loss.h"

#include <cassert>
#include <cstring>

#include "spirv/loss.comp.h"
#include "training/step/array_buffers.h"
#include "training/step/camera_colour.h"

namespace neuvv::training {

LossBatch::LossBatch(const gpu::Device& device, uint32_t tiles)
    : target(device, "targets", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kUpload,
             VK_FORMAT_R32G32B32A32_SFLOAT),
      background(device, "backgrounds", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kUpload,
                 VK_FORMAT_R32G32B32A32_SFLOAT),
      adjoint(device, "ray adjoints", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kDevice,
              VK_FORMAT_R32G32B32A32_SFLOAT),
      sums(device, "loss sums", uint64_t{16} * tiles, gpu::MemoryKind::kDevice),
      colours(device, "colours", sizeof(CameraColour) * tiles, gpu::MemoryKind::kUpload),
      colour_gradients(device, "colour gradients", sizeof(CameraColour) * tiles, gpu::MemoryKind::kDevice) {}

namespace {

void load_colours(const Dataset& dataset, const Batch& batch, const LossBatch& loss_batch,
                  const CameraColours& colours) {
    for (size_t tile = 0; tile < batch.tiles.size(); ++tile) {
        const CameraColour colour = colours.of_tile(batch, tile, dataset.cameras[batch.tiles[tile].camera]);
        const CameraColour back = inverse(colour);
        loss_batch.colours.as<CameraColour>()[tile] = colour;
        for (size_t ray = tile * kTilePixels; ray < (tile + 1) * kTilePixels; ++ray) {
            const glm::vec4 target = batch.target[ray];
            if (target.a >= 0) loss_batch.target.as<glm::vec4>()[ray] = glm::vec4(seen(back, target), target.a);
        }
    }
}

}  // namespace

void load_batch(const Dataset& dataset, const Batch& batch, const render::RayBatch& rays, const LossBatch& loss_batch,
                const CameraColours& colours) {
    assert(batch.tiles.size() <= rays.tile_capacity && "more tiles than there is room for");
    for (size_t i = 0; i < dataset.cameras.size(); ++i)
        rays.cameras.as<ShaderCamera>()[i] = render::shader_camera(stage::enlarged(dataset.cameras[i], batch.samples));
    if (batch.tiles.empty()) return;  // of a member of a team, where few tiles are left
    std::memcpy(rays.tiles.mapped, batch.tiles.data(), batch.tiles.size() * sizeof(Tile));
    std::memcpy(loss_batch.target.mapped, batch.target.data(), batch.target.size() * sizeof(glm::vec4));
    std::memcpy(loss_batch.background.mapped, batch.background.data(), batch.background.size() * sizeof(glm::vec4));
    if (!colours.empty()) load_colours(dataset, batch, loss_batch, colours);
}

Loss::Loss(const gpu::Device& device, const render::RayBatch& rays, const LossBatch& batch)
    : pass(device, "loss", array_buffers(device).fitting(loss_comp, loss_comp_storage)),
      set(pass, {{kLossRadiance, &rays.radiance},
                 {kLossTarget, &batch.target},
                 {kLossBackground, &batch.background},
                 {kLossAdjoint, &batch.adjoint},
                 {kLossSums, &batch.sums},
                 {kLossColours, &batch.colours},
                 {kLossColourGradients, &batch.colour_gradients}}) {}

void record_loss(gpu::Commands& commands, const Loss& loss, uint32_t tiles, const LossWeights& weights,
                 uint32_t samples, bool colours) {
    assert(samples >= 1 && kTile % samples == 0 && "whole pixels in a tile");
    const gpu::PassScope scope(commands, "loss");
    gpu::dispatch_groups(commands, loss.pass, loss.set, tiles, LossPush{weights, samples, colours ? 1u : 0u});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
