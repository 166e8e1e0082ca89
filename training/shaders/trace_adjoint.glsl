// The adjoint of trace (ray_adjoint.glsl): adds gradients to the σ and SH of every leaf that a ray crosses. It reads
// the slice as trace.comp does and adds gradient_stride floats per sample to the sample's slot. One workgroup per tile,
// one thread per ray. Bound by these atomic additions.
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
READ_ARRAY(uint, kTraceLinks, tree_links);
READ_ARRAY(uvec4, kTraceNodes, tree_nodes);
READ_ARRAY(uvec2, kTraceNodeLive, node_live);
READ_ARRAY(uvec2, kTraceHead, head);
READ_ARRAY(vec4, kTraceSh, slice_sh);
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
READ_ARRAY(vec4, kTraceRadiance, radiance);
READ_ARRAY(vec4, kTraceAdjoint, adjoint);
READ_ARRAY(vec4, kTraceTarget, target);
layout(binding = kTraceMaxWeight, std430) buffer MaxWeight { uint max_weight[]; };
layout(push_constant) uniform Push { TraceAdjointPush push; };
#define NEUVV_GRADIENTS_BINDING kTraceGradients
#include "gradient_add.glsl"
#include "trace/slice_sample.glsl"
#include "rays/every_tile.glsl"
#include "ray_adjoint.glsl"

// Adds the derivatives of one sample to its slot.
void scatter(float weight, float d_sigma, float opacity_sensitivity, vec3 d_raw) {
    atomicMax(max_weight[slot], max(floatBitsToUint(weight), 1u));
    uint at = slot * gradient_stride(kHhDegree);
    gradient_add(at++, d_sigma);
    gradient_add(at++, opacity_sensitivity);
    for (uint j = 0u; j < sh_count(kHhDegree); ++j)
        for (uint channel = 0u; channel < 3u; ++channel) gradient_add(at++, sh_y[j] * d_raw[channel]);
}
