// For ray.glsl, where each tile of the batch has a workgroup and rays have no end.
#ifndef NEUVV_EVERY_TILE_GLSL
#define NEUVV_EVERY_TILE_GLSL

// The dispatch rounds a very large number of tiles up, so the result must be checked against the buffers' size.
uint tile_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

vec2 tile_range(uint tile) { return vec2(0.0, 1e30); }

uint first_camera() { return 0u; }

float set_end(uint view, vec2 at) { return 1e30; }

#endif
