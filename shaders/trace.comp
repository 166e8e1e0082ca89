// Trace: the rays of tiles of 8×8 pixels through a slice with slots.
// Reads topology, head (σ, slot) and SH of live leaves; writes radiance and depth. One workgroup per tile, one thread
// per ray. Bound by the dependent fetches of the walk, then by (n_max+1)² texels of SH per sample.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
const bool kRestart = false, kFromRoot = false, kCoalesce = true;
const uint kSampleCost = kSampleBelowDescent;
layout(binding = kTraceTop) uniform utextureBuffer tree_top;
layout(binding = kTraceNodes) uniform utextureBuffer tree_nodes;
layout(binding = kTraceChildren) uniform utextureBuffer tree_children;
layout(binding = kTraceNodeLive) uniform utextureBuffer node_live;
layout(binding = kTraceHead) uniform utextureBuffer head;
layout(binding = kTraceSh) uniform textureBuffer slice_sh;
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
layout(binding = kTraceRadiance, rgba32f) uniform imageBuffer radiance;
layout(binding = kTraceDepth, r32f) uniform imageBuffer depth;
layout(push_constant) uniform Push { TracePush push; };
#include "slice_sample.glsl"
#include "every_tile.glsl"
#include "composite.glsl"
#include "ray.glsl"
#include "store_ray.glsl"
#include "trace_rays.glsl"
