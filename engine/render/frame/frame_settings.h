// What a frame shows and how, and the largest frames for which a renderer is made.
#pragma once

#include <vector>

#include "render/rays/ray_grid.h"
#include "render/rays/resolve.h"
#include "render/volume/performer.h"

namespace neuvv::render {

enum class TraceMode {
    kPlay,    // slice trees, shaded per leaf where that looks the same (play_shading)
    kShaded,  // slice trees with one colour per leaf
    kTree,    // slice trees, SH along each ray
};

enum class Blend {
    kExact,  // instances whose boxes overlap along a ray are marched together, in depth order
    kPaper,  // each instance is a layer, and layers are blended by depth: the paper's Algorithm 1 (errata 11)
};

struct FrameSettings {
    std::vector<Instance> instances = std::vector<Instance>(1);  // at most kMaxInstances
    uint32_t width = 0, height = 0;
    uint32_t samples = 1;  // rays per pixel along each side: 2 averages four rays
    double scale = 1;      // rays per pixel along each side; below 1 the image is upscaled, and `samples` must be 1
    std::vector<Fovea> foveae;             // one per view, or none; with foveae `samples` must be 1
    std::vector<Instance> next_instances;  // of the next images, in their order: their slices are prefetched
    uint32_t prefetch_parts = 2;           // parts that are prefetched with each image; a slice has kSliceParts
    ResolveSettings resolve;               // an inspection leaves out the set and its lights
    TraceMode mode = TraceMode::kTree;
    Blend blend = Blend::kExact;
    bool lit = true;  // whether the set's lights shine on performers; else they have the light of their capture
    float stop = kStopTransmittance;
    // Whether performers whose leaves look smaller than the distance between two rays are drawn from Field::coarser,
    // where the fields have it. Painted ones never are, as paint refers to leaves; nor is any where the device has no
    // memory for slices of all levels.
    bool far_levels = true;
};

constexpr uint32_t kMaxInstances = 512;

// The numbers of each performer's targets: the views, and the shadow maps of lights.
constexpr uint32_t kEyeTarget = 0, kLightTarget = 1;

// The largest frames that a renderer can draw.
struct FrameCapacity {
    uint32_t width = 0, height = 0;
    uint32_t samples = 1;
    uint32_t views = 1;
    // Bytes of slices, or less where the device has not so much left (slice_budget), in equal shares for all fields (or
    // as FrameRenderer::change_fields says). With FrameSettings::far_levels their coarser levels take as much for each
    // leaf, which is about a third more in all. 0: no slices; the direct path draws all that is not painted. Fields
    // that came with their slice count for nothing here.
    uint64_t slice_budget = kSliceBudget;
    uint64_t interval_budget = UINT64_MAX;  // bytes of intervals that are merged at once
};

}  // namespace neuvv::render
