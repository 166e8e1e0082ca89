// Performers' shadows: coarse, low-passed maps of the alpha and depth of performers as lights see them (errata 15).
#pragma once

#include <memory>

#include "render/rays/clear_rays.h"
#include "render/rays/view_layout.h"
#include "render/set/set_lighting.h"
#include "render/volume/field_levels.h"
#include "render/volume/instance_cameras.h"
#include "render/volume/shadow_blur.h"

namespace neuvv::render {

struct PerformerShadows {
    // The maps are written to lighting.performer_shadows. `target` must be added to every performer
    // (Performer::add_target, with kMaxShadows views). `instances` is the largest number of instances.
    PerformerShadows(const gpu::Device& device, SetLighting& lighting, uint32_t instances);

    // To be called before a frame and after SetLighting::light: finds the instances that cast shadows. Their fields are
    // indices into levels.all.
    void prepare(const FieldLevels& levels, std::span<const Instance> instances);

    void prepare_lights(const FieldLevels& levels, std::span<const Instance> instances);
    SetLighting& lighting;
    RayTarget target;
    RayClearer clearer;
    ShadowBlur blur;
    std::vector<stage::Camera> cameras;  // of the lights that have maps, at their positions
    std::vector<uint32_t> maps;          // per camera, the index of its map
    ViewLayout layout;
    std::vector<DrawnInstance> drawn;
};

// `target` is the number that Performer::add_target returned for the shadows' target. To be recorded after the slices
// and before the set and the rays of the views.
void record_performer_shadows(gpu::Commands& commands, PerformerShadows& shadows,
                              std::span<const std::unique_ptr<Performer>> performers, uint32_t target);

}  // namespace neuvv::render
