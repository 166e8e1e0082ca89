// Trace: rays of pixel tiles through a field, by its slice or directly.
#pragma once

#include <vector>

#include "gpu/commands.h"
#include "render/field.h"
#include "render/slice.h"
#include "shared/trace.h"
#include "stage/camera.h"

namespace neuvv::render {

// Rays on the device: tiles of 8×8 pixels of some cameras, and what tracing them gave, in tile order.
struct RayBatch {
    // At most `cameras` cameras and `tiles` tiles.
    RayBatch(const gpu::Device& device, uint32_t cameras, uint32_t tiles);

    uint32_t camera_capacity, tile_capacity;
    gpu::Buffer cameras;   // ShaderCamera, host-mapped
    gpu::Buffer tiles;     // Tile, host-mapped
    gpu::Buffer radiance;  // per ray premultiplied linear RGB and alpha
    gpu::Buffer depth;     // per ray metres (errata 12)
};

// `camera` is enlarged so that its pixels are the samples × samples rays of an image's pixel (ray.glsl spreads them);
// 1 where rays leave pixels' centres, or tiles say where.
ShaderCamera shader_camera(const stage::Camera& camera, uint32_t samples = 1);

// The camera in the space of a performer that stands at `world_from_performer`, which must be invertible (errata 13).
stage::Camera in_performer(stage::Camera camera, const glm::mat4& world_from_performer);

// Every tile of one image, row by row.
std::vector<Tile> tiles_of_image(uint32_t camera, uint32_t width, uint32_t height);

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
    kFromGrid,  // from the grid over the upper levels, and within a node in registers
    kFromRoot,  // the paper's: from the root to every cell
};

// What becomes of the rays of an instance (kRayOutput… of shared/trace.h).
enum class RayOutput : uint32_t {
    kLayer = kOutputLayer,                // under all that stands there: instances in draw order
    kLayerByDepth = kOutputLayerByDepth,  // over or under it: the paper's Algorithm 1 (errata 11)
    kSegments = kOutputSegments,          // to be merged with others
    kInspect = kOutputInspect,            // what their walks were like, in place of light (shared/inspect.h)
};

// Some of a target's tiles of rays: first..end−1.
struct TileSpan {
    uint32_t first = 0, end = UINT32_MAX;
};

// How an instance's rays are traced. Its cameras stand in the batch from `first_camera` on, one a view; the batch's
// first are the world's.
struct InstanceRays {
    uint32_t first_camera = 0;
    float opacity = 1;
    float stop = kStopTransmittance;
    TileSpan tiles;
    glm::uvec2 set_size{0};  // texels of the set's depth in a view; 0: there is no set
    uint32_t lighting = 0;   // of kLit, kShadowed
};

struct RayTarget;
class Segments;

// The paper's way, all numbers of a leaf at each sample. Needs only the rows of a slice (record_rows).
struct DirectTracer {
    DirectTracer(const gpu::Device& device, const Field& field, const LiveLeaves& live, const RayBatch& rays,
                 Walk walk = Walk::kFromGrid);
    // For instances. `segments`: not null where these are what rays become.
    DirectTracer(const gpu::Device& device, const Field& field, const LiveLeaves& live, const RayTarget& target,
                 RayOutput output, const Segments* segments);

    const Field& field;
    const gpu::Buffer* tile_count = nullptr;
    gpu::Buffer no_lights;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

void record_direct(gpu::Commands& commands, const DirectTracer& tracer, uint32_t tiles,
                   float stop = kStopTransmittance);

// As record_trace_tree, where an instance has no slice.
void record_direct_instance(gpu::Commands& commands, const DirectTracer& tracer, const InstanceRays& rays);

// What they pass and bind to their shader: of a field alone, and of an instance.
TracePush trace_push(const Field& field, float stop);
TracePush instance_push(const Field& field, const InstanceRays& rays);
gpu::Bindings trace_bindings(const Field& field, const RayBatch& rays);
// `segments` only where they are what rays become: they are made anew for more.
gpu::Bindings instance_bindings(const Field& field, const RayTarget& target, RayOutput output,
                                const Segments* segments);

}  // namespace neuvv::render
