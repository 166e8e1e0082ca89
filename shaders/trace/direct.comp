// The paper's rendering without a slice: all weights of a leaf are evaluated at every sample. This is the reference for
// speed and correctness. Where kRayOutput is not kOutputRay, it traces an instance that has no slice, in the tiles that
// the instance may cover.
// Reads topology, weights and rows; writes as store_instance.glsl describes. One workgroup per tile, one thread per
// ray. Bound by memory: 16·(2⌈C/4⌉ + N_HH) bytes per sample. main() is in trace_rays.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/lights.h"
#include "shared/intervals.h"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
layout(constant_id = 3) const uint kBasisPlanes = 8u;
layout(constant_id = 4) const uint kBusyPlanes = 8u;
layout(constant_id = 5) const bool kRestart = false;
layout(constant_id = 6) const uint kRayOutput = kOutputRay;
layout(constant_id = 7) const bool kHalfWeights = false;
layout(constant_id = 8) const bool kSrgbColours = false;
layout(constant_id = 9) const bool kWeightsByAddress = false;
#define OTHER_WALK
const bool kFromRoot = kRestart, kCoalesce = true;
const uint kSampleCost = kSampleAboveDescent;
READ_ARRAY(uint, kTraceLinks, tree_links);
READ_ARRAY(uvec4, kTraceNodes, tree_nodes);
READ_ARRAY(any4, kTraceWeights, leaf_weights);
layout(binding = kTraceRows, std140) uniform Rows { BasisRows rows; };
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
layout(binding = kTraceTileList) uniform utextureBuffer tile_list;
layout(binding = kTraceTileRanges) uniform utextureBuffer tile_ranges;
UPDATE_ARRAY(vec4, kTraceRadiance, radiance);
UPDATE_ARRAY(float, kTraceDepth, depth);
layout(binding = kTracePages, std430) buffer Pages { uvec4 pages[]; };
layout(binding = kTracePages, std430) buffer Heads { uint heads[]; };
READ_ARRAY(float, kTraceSetDepth, set_depth);
layout(binding = kTraceLights, std140) uniform Lights { ShaderLights lights; };
READ_ARRAY(float, kTraceSetShadows, set_shadow_maps);
layout(binding = kTraceSharing) uniform utextureBuffer sharing;
layout(binding = kTracePerformerShadows) uniform textureBuffer performer_shadows;
layout(push_constant) uniform Push { TracePush push; };
#include "trace/direct_sample.glsl"
#include "rays/listed_tiles.glsl"
#include "trace/composite.glsl"
#include "rays/ray.glsl"
#include "trace/store_instance.glsl"
#include "trace/trace_rays.glsl"
