// Trace: the rays of tiles of 8×8 pixels through a slice with slots.
// Reads topology, head (σ, slot) and SH of live leaves; writes radiance and depth. One workgroup per tile, one thread
// per ray. Bound by the dependent fetches of the walk, then by (n_max+1)² texels of SH per sample. main() is in
// trace_rays.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
layout(constant_id = 3) const bool kSrgbColours = false;
const uint kSampleCost = kSampleBelowDescent;
READ_ARRAY(uint, kTraceLinks, tree_links);
READ_ARRAY(uvec4, kTraceNodes, tree_nodes);
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
UPDATE_ARRAY(vec4, kTraceRadiance, radiance);
UPDATE_ARRAY(float, kTraceDepth, depth);
layout(push_constant) uniform Push { TracePush push; };
#include "trace/slice_sample.glsl"
#include "rays/every_tile.glsl"
#include "trace/composite.glsl"
#include "rays/ray.glsl"
#include "trace/store_ray.glsl"
#include "trace/trace_rays.glsl"
