#include "training/loss.h"

#include <cassert>
#include <cstring>

#include "spirv/loss.comp.h"

namespace neuvv::training {

LossBatch::LossBatch(const gpu::Device& device, uint32_t tiles)
    : target(device, "targets", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kUpload,
             VK_FORMAT_R32G32B32A32_SFLOAT),
      background(device, "backgrounds", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kUpload,
                 VK_FORMAT_R32G32B32A32_SFLOAT),
      adjoint(device, "ray adjoints", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kDevice,
              VK_FORMAT_R32G32B32A32_SFLOAT),
      sums(device, "loss sums", uint64_t{16} * tiles, gpu::MemoryKind::kDevice) {}

void load_batch(const Dataset& dataset, const Batch& batch, const render::RayBatch& rays, const LossBatch& loss_batch) {
    assert(batch.tiles.size() <= rays.tile_capacity && "more tiles than there is room for");
    for (size_t i = 0; i < dataset.cameras.size(); i++)
        rays.cameras.as<ShaderCamera>()[i] = render::shader_camera(stage::enlarged(dataset.cameras[i], batch.samples));
    std::memcpy(rays.tiles.mapped, batch.tiles.data(), batch.tiles.size() * sizeof(Tile));
    std::memcpy(loss_batch.target.mapped, batch.target.data(), batch.target.size() * sizeof(glm::vec4));
    std::memcpy(loss_batch.background.mapped, batch.background.data(), batch.background.size() * sizeof(glm::vec4));
}

Loss::Loss(const gpu::Device& device, const render::RayBatch& rays, const LossBatch& batch)
    : pass(device, "loss", loss_comp),
      set(pass, {{kLossRadiance, &rays.radiance},
                 {kLossTarget, &batch.target},
                 {kLossBackground, &batch.background},
                 {kLossAdjoint, &batch.adjoint},
                 {kLossSums, &batch.sums}}) {}

void record_loss(gpu::Commands& commands, const Loss& loss, uint32_t tiles, const LossWeights& weights,
                 uint32_t samples) {
    assert(samples >= 1 && kTile % samples == 0 && "whole pixels in a tile");
    const gpu::PassScope scope(commands, "loss");
    gpu::dispatch_groups(commands, loss.pass, loss.set, tiles, LossPush{weights, samples});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
