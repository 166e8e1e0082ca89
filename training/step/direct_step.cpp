#include "training/step/direct_step.h"

namespace neuvv::training {

DirectStep::DirectStep(const gpu::Device& device, const voctree::VOctree& tree, uint32_t cameras, uint32_t tiles,
                       AtomicAdd atomics)
    : field_(training_field(device, tree)),
      live_(device, field_, 1),
      rays_(device, cameras, tiles),
      batch_(device, tiles),
      gradients_(device, "weight gradients", field_.whole_weights().bytes, gpu::MemoryKind::kDevice),
      finder_(device, field_, live_),
      tracer_(device, field_, live_, rays_),
      loss_(device, rays_, batch_),
      adjoint_(device, field_, live_, rays_, batch_, gradients_, atomics),
      commands_(device, "direct step") {}

void DirectStep::run(const StepSettings& settings) {
    commands_.begin();
    gpu::fill(commands_, gradients_, 0);
    render::record_rows(commands_, finder_, settings.frame);
    render::record_direct(commands_, tracer_, settings.tiles, settings.stop);
    record_loss(commands_, loss_, settings.tiles, settings.weights, settings.samples);
    record_direct_adjoint(commands_, adjoint_, settings.tiles, settings.stop, settings.weights, settings.pixel_share());
    commands_.submit();
    commands_.wait();
}

}  // namespace neuvv::training
