// Performers' shadows: alpha and depth of performers as lights see them, coarse and low-passed (errata 15).
#pragma once

#include <memory>

#include "render/instance_cameras.h"
#include "render/set_lights.h"
#include "render/set_raster.h"

namespace neuvv::render {

struct PerformerShadows {
    // Into set.performer_shadows. Performers must be given the target (Performer::add_target, of kMaxShadows views).
    PerformerShadows(const gpu::Device& device, SetRaster& set, uint32_t instances);

    // Before a frame, after SetRaster::light: the instances that may cast shadows.
    void prepare(std::span<const Field* const> fields, std::span<const Instance> instances);

    void prepare_lights(std::span<const Field* const> fields, std::span<const Instance> instances);
    SetRaster& set;
    RayTarget target;
    gpu::Buffer rows;
    gpu::ComputePass along_rows, along_columns;
    gpu::BindingSet rows_set, columns_set;
    std::vector<stage::Camera> cameras;  // of the lights that have maps
    std::vector<uint32_t> maps;          // of each, which map it fills
    ViewLayout layout;
    std::vector<DrawnInstance> drawn;
};

// `target`: the performers' number of the shadows' target. After the slices, before the set and the eye's rays.
void record_performer_shadows(gpu::Commands& commands, PerformerShadows& shadows,
                              std::span<const std::unique_ptr<Performer>> performers, uint32_t target);

}  // namespace neuvv::render
