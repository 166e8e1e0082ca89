// Trace tree: traces an instance through its slice tree, shaded or not, in the tiles of 8×8 pixels that it may cover.
// Reads nodes and entries; writes as store_instance.glsl describes. One workgroup per tile, one thread per ray,
// dispatched indirectly. Bound by the walk: two dependent fetches per node and one per sample. Bindings and constants
// are in trace_tree.glsl, main() is in trace_rays.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "trace/trace_tree.glsl"
