// Bindings, constants and includes of trace_tree.comp, which measurements of other walks share
// (tools/bench/shaders/other_walks.comp).
#include "arrays.glsl"
#include "shared/lights.h"
#include "shared/intervals.h"
#include "shared/slice_tree.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
layout(constant_id = 3) const bool kShaded = true;
layout(constant_id = 4) const uint kRayOutput = kOutputLayer;
layout(constant_id = 5) const bool kColourless = false;
layout(constant_id = 6) const bool kSrgbColours = false;
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
