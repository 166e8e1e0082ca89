// Every tile of the batch has a workgroup, and its rays have no end (ray.glsl).
#ifndef NEUVV_EVERY_TILE_GLSL
#define NEUVV_EVERY_TILE_GLSL

// A dispatch of very many tiles rounds their number up: check it against the buffers' end.
uint tile_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

vec2 tile_range(uint tile) { return vec2(0.0, 1e30); }

uint first_camera() { return 0u; }

float set_end(uint view, vec2 at) { return 1e30; }

#endif
