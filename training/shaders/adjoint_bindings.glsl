// What trace_adjoint.glsl and direct_adjoint.glsl have alike: their threads, the constants of the walk, what they read
// of rays and pixels, and the gradients that they add to. To be included before the samples of trace/, which need it.
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
READ_ARRAY(uint, kTraceLinks, tree_links);
READ_ARRAY(uvec4, kTraceNodes, tree_nodes);
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
READ_ARRAY(vec4, kTraceRadiance, radiance);
READ_ARRAY(vec4, kTraceAdjoint, adjoint);
READ_ARRAY(vec4, kTraceTarget, target);
layout(push_constant) uniform Push { TraceAdjointPush push; };
#define NEUVV_GRADIENTS_BINDING kTraceGradients
#include "gradient_add.glsl"
#include "rays/every_tile.glsl"
