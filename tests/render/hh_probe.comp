// Evaluates hh.glsl and sh.glsl at the points of a buffer, one thread per point.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "hh_probe.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(binding = kHhProbePoints, std430) readonly buffer Points { vec4 points[]; };
layout(binding = kHhProbeOut, std430) writeonly buffer Out { HhProbe results[]; };
layout(push_constant) uniform Push { uint count; };
#include "slice/hh.glsl"
#include "slice/sh.glsl"

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    const HhRadial r = hh_radial(points[i].w), s = hh_radial_adjoint(points[i].w);
    const float[kMaxShCount] y = sh_basis(points[i].xyz);
    results[i].radial = vec4[](r.l0, r.l1, r.l2, r.l3);
    results[i].slope = vec4[](s.l0, s.l1, s.l2, s.l3);
    for (uint j = 0u; j < kMaxShCount; ++j) results[i].sh[j / 4u][j % 4u] = y[j];
}
