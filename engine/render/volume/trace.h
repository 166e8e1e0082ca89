// Trace: the rays of pixel tiles through a field, by its slice or directly.
#pragma once

#include "render/rays/ray_batch.h"
#include "render/volume/slices/field.h"
#include "render/volume/slices/slice.h"

namespace neuvv::render {

constexpr float kStopTransmittance = 1.0f / 4096;  // changes no 8-bit sRGB value by more than a step, even on black

struct Tracer {
    Tracer(const gpu::Device& device, const Field& field, const Slice& slice, const RayBatch& rays);

    const Field& field;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Traces the first `tiles` tiles of the batch. `stop` is the transmittance below which rays end (0: never).
void record_trace(gpu::Commands& commands, const Tracer& tracer, uint32_t tiles, float stop = kStopTransmittance);

enum class Walk {
    kFromGrid,  // from the grid over the upper levels, with the masks of a node in registers
    kFromRoot,  // the paper's walk: from the root to every cell
};

// How the rays of an instance are combined with those of earlier instances in the target (kOutput… of shared/trace.h).
enum class RayOutput : uint32_t {
    kLayer = kOutputLayer,                // under what is there: for instances in draw order
    kLayerByDepth = kOutputLayerByDepth,  // over or under it, by depth: the paper's Algorithm 1 (errata 11)
    kIntervals = kOutputIntervals,        // stored as intervals, to be merged with those of others
    kInspect = kOutputInspect,            // level and steps of the walks in place of light (shared/inspect.h)
};

// The tiles first..end−1 of a target's tiles of rays.
struct TileSpan {
    uint32_t first = 0, end = UINT32_MAX;
};

// How an instance's rays are traced. Its cameras are in the batch from `first_camera` on, one per view. The first
// cameras of the batch are those of the views in world space.
struct InstanceRays {
    uint32_t first_camera = 0;
    float opacity = 1, density = 1;  // Instance
    float stop = kStopTransmittance;
    TileSpan tiles;
    glm::uvec2 set_size{0};  // texels of the set's depth in a view; 0: no set
    uint32_t lighting = 0;   // bits kLit, kShadowed
};

struct RayTarget;
class Intervals;

// Traces as the paper does, with all numbers of a leaf at each sample. It needs only the rows of a slice (record_rows).
struct DirectTracer {
    DirectTracer(const gpu::Device& device, const Field& field, const LiveLeaves& live, const RayBatch& rays,
                 Walk walk = Walk::kFromGrid);
    // For instances. `intervals` must not be null where `output` is kIntervals (assert).
    DirectTracer(const gpu::Device& device, const Field& field, const LiveLeaves& live, const RayTarget& target,
                 RayOutput output, const Intervals* intervals);

    const Field& field;
    const gpu::Buffer* tile_count = nullptr;
    gpu::Buffer no_lights;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

void record_direct(gpu::Commands& commands, const DirectTracer& tracer, uint32_t tiles,
                   float stop = kStopTransmittance);

// Traces an instance that has no slice; see record_trace_tree.
void record_direct_instance(gpu::Commands& commands, const DirectTracer& tracer, const InstanceRays& rays);

// The push constants and bindings of trace shaders, for a field alone and for an instance.
TracePush trace_push(const Field& field, float stop);
TracePush instance_push(const Field& field, const InstanceRays& rays);
gpu::Bindings trace_bindings(const Field& field, const RayBatch& rays);
// `intervals` are bound only where `output` is kIntervals, because their buffers may be replaced by larger ones.
gpu::Bindings instance_bindings(const Field& field, const RayTarget& target, RayOutput output,
                                const Intervals* intervals);

}  // namespace neuvv::render
