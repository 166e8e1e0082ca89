// Trace tree: traces an instance through its slice tree, shaded or not, in the tiles of 8×8 pixels that it may cover.
// Reads nodes and entries; writes as store_instance.glsl describes. One workgroup per tile, one thread per ray,
// dispatched indirectly. Bound by the walk: two dependent fetches per node and one per sample. main() is in
// trace_rays.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/lights.h"
#include "shared/intervals.h"
#include "shared/slice_tree.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
layout(constant_id = 3) const bool kShaded = true;
layout(constant_id = 4) const bool kRestart = false;
layout(constant_id = 5) const bool kFromRoot = false;
layout(constant_id = 6) const bool kCoalesce = true;
layout(constant_id = 7) const uint kRayOutput = kOutputLayer;
layout(constant_id = 8) const bool kColourless = false;
layout(constant_id = 9) const bool kSrgbColours = false;
const uint kSampleCost = kShaded || kColourless ? kSampleLikeStep : kSampleBelowDescent;
READ_ARRAY(uint, kTraceLinks, tree_links);
READ_ARRAY(uvec4, kTraceNodes, nodes);
READ_ARRAY(uvec2, kTraceEntries, entries);
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

#include "rays/listed_tiles.glsl"
#include "trace/tree_sample.glsl"
#include "trace/composite.glsl"
#include "rays/ray.glsl"
#include "trace/store_instance.glsl"
#include "trace/trace_rays.glsl"
