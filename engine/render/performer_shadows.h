// Performers' shadows: alpha and depth of performers as lights see them, coarse and low-passed (errata 15).
#pragma once

#include <memory>

#include "render/place.h"
#include "render/set_lights.h"
#include "render/set_raster.h"

namespace neuvv::render {

class PerformerShadows {
  public:
    // Into set.performer_shadows. Performers must be given the target (Performer::add_target, of kMaxShadows views).
    PerformerShadows(const gpu::Device& device, SetRaster& set, uint32_t instances);

    const RayTarget& target() const { return target_; }

    // Before a frame, after SetRaster::light: the instances that may cast shadows.
    void place(std::span<const Field* const> fields, std::span<const Instance> instances);
    std::span<const DrawnInstance> drawn() const { return drawn_; }

  private:
    friend void record_performer_shadows(gpu::Commands&, PerformerShadows&, std::span<const std::unique_ptr<Performer>>,
                                         uint32_t);
    void place_lights(std::span<const Field* const> fields, std::span<const Instance> instances);
    SetRaster& set_;
    RayTarget target_;
    gpu::Buffer rows_;
    gpu::ComputePass along_rows_, along_columns_;
    gpu::BindingSet rows_set_, columns_set_;
    std::vector<stage::Camera> cameras_;  // of the lights that have maps
    std::vector<uint32_t> maps_;          // of each, which map it fills
    ViewLayout layout_;
    std::vector<DrawnInstance> drawn_;
};

// `target`: the performers' number of the shadows' target. After the slices, before the set and the eye's rays.
void record_performer_shadows(gpu::Commands& commands, PerformerShadows& shadows,
                              std::span<const std::unique_ptr<Performer>> performers, uint32_t target);

}  // namespace neuvv::render
