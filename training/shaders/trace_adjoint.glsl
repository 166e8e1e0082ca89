// The adjoint of trace (ray_adjoint.glsl): adds gradients to the σ and SH of every leaf that a ray crosses. It reads
// the slice as trace.comp does and adds gradient_stride floats per sample to the sample's slot. One workgroup per tile,
// one thread per ray. Bound by these atomic additions.
#include "adjoint_bindings.glsl"
#include "trace/slice_sample.glsl"
#include "ray_adjoint.glsl"

layout(binding = kTraceMaxWeight, std430) buffer MaxWeight { uint max_weight[]; };

// Adds the derivatives of one sample to its slot.
void scatter(float weight, float d_sigma, float opacity_sensitivity, vec3 d_raw) {
    atomicMax(max_weight[slot], max(floatBitsToUint(weight), 1u));
    uint at = slot * gradient_stride(kHhDegree);
    gradient_add(at++, d_sigma);
    gradient_add(at++, opacity_sensitivity);
    for (uint j = 0u; j < sh_count(kHhDegree); ++j)
        for (uint channel = 0u; channel < 3u; ++channel) gradient_add(at++, sh_y[j] * d_raw[channel]);
}
