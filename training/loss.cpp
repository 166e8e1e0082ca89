#include "training/loss.h"

#include "spirv/loss.comp.h"

namespace neuvv {

LossBatch::LossBatch(const Device& device, uint32_t tiles)
    : target(device, "targets", uint64_t{16} * kTilePixels * tiles, MemoryKind::kUpload, VK_FORMAT_R32G32B32A32_SFLOAT),
      background(device, "backgrounds", uint64_t{16} * kTilePixels * tiles, MemoryKind::kUpload,
                 VK_FORMAT_R32G32B32A32_SFLOAT),
      adjoint(device, "ray adjoints", uint64_t{16} * kTilePixels * tiles, MemoryKind::kDevice,
              VK_FORMAT_R32G32B32A32_SFLOAT),
      sums(device, "loss sums", uint64_t{16} * tiles, MemoryKind::kDevice) {}

Loss::Loss(const Device& device, const RayBatch& rays, const LossBatch& batch)
    : pass_(device, "loss", loss_comp),
      set_(pass_, {{kLossRadiance, &rays.radiance},
                   {kLossTarget, &batch.target},
                   {kLossBackground, &batch.background},
                   {kLossAdjoint, &batch.adjoint},
                   {kLossSums, &batch.sums}}) {}

void record_loss(Commands& commands, const Loss& loss, uint32_t tiles, float lambda_grad) {
    const PassScope scope(commands, "loss");
    dispatch(commands, loss.pass_, loss.set_, tiles, LossPush{lambda_grad});
    compute_barrier(commands);
}

}  // namespace neuvv
