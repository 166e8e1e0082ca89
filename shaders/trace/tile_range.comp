// Tile range: the smallest and largest distance of an instance in each tile that it may cover. The box around the live
// leaves of each node is projected onto tiles. Rays start at the smallest distance of their tile and end at the
// largest; a tile that no box covers has no rays.
// Reads nodes, down to a level whose nodes look smaller than a tile; reads two words of each covered tile, and updates
// those that change by atomic minima. One thread per node, for all views. Bound by arithmetic, about 150 operations per
// live node and view, and, where the eye is near, by these reads.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
READ_ARRAY(uvec4, kRangeNodes, nodes);
READ_ARRAY(uvec2, kRangeCells, node_cells);
READ_ARRAY(uvec2, kRangePositions, node_positions);
// All lanes read the same view at a time.
layout(binding = kRangeViews, std430) readonly buffer Views { RangeView range_views[]; };
layout(binding = kRangeTiles, std430) buffer Tiles { uint tile_ranges[]; };
layout(push_constant) uniform Push { TileRangePush push; };
#include "rays/box_pixels.glsl"
#include "rays/grid_axis.glsl"

const float kSlack = 1e-4;  // relative tolerance of distances, for rounding

struct Box {
    vec3 low, high;
};

// The first and the last layer of cells along an axis that is not empty, given the occupied cells of each layer.
uvec2 first_and_last(uint layer0, uint layer1, uint layer2, uint layer3) {
    const uint any = (layer0 != 0u ? 1u : 0u) | (layer1 != 0u ? 2u : 0u) | (layer2 != 0u ? 4u : 0u) |
                     (layer3 != 0u ? 8u : 0u);
    return uvec2(findLSB(any), findMSB(any));
}

// The box around some of a node's cells, in units of cells: 0..4 on each axis. The bits of a cell's number in its word
// are y1 x1 z0 y0 x0 (shared/tree.h).
Box cells_box(uvec2 cells) {
    const uint any = cells.x | cells.y;
    const uvec2 x = first_and_last(any & 0x00550055u, any & 0x00aa00aau, any & 0x55005500u, any & 0xaa00aa00u);
    const uvec2 y = first_and_last(any & 0x00003333u, any & 0x0000ccccu, any & 0x33330000u, any & 0xcccc0000u);
    const uvec2 z = first_and_last(cells.x & 0x0f0f0f0fu, cells.x & 0xf0f0f0f0u, cells.y & 0x0f0f0f0fu,
                                   cells.y & 0xf0f0f0f0u);
    return Box(vec3(x.x, y.x, z.x), vec3(x.y, y.y, z.y) + 1.0);
}

// z (x, y, 1) for the pixel (x, y) onto which a position is projected; `from_eye` is relative to the eye.
vec3 homogeneous(RangeView view, vec3 from_eye) {
    return vec3(dot(view.row_x.xyz, from_eye), dot(view.row_y.xyz, from_eye), dot(view.row_z.xyz, from_eye));
}

// Updates the tiles that a box (performer's space, metres) covers in one view.
void store_range(uint v, Box performer_box) {
    const RangeView view = range_views[push.first_view + v];
    const Box box = Box(performer_box.low - view.eye.xyz, performer_box.high - view.eye.xyz);
    const float near = length(max(max(box.low, -box.high), 0.0)) * (1.0 - kSlack);
    const float far = length(max(abs(box.low), abs(box.high))) * (1.0 + kSlack);
    const vec2 tiles = vec2(push.tiles_across, push.tiles_down);
    const vec3 size = box.high - box.low;
    const mat3 edges = mat3(homogeneous(view, vec3(size.x, 0.0, 0.0)), homogeneous(view, vec3(0.0, size.y, 0.0)),
                            homogeneous(view, vec3(0.0, 0.0, size.z)));
    const vec4 pixels = box_pixels(homogeneous(view, box.low), edges);
    vec4 covered = vec4(ray_of_pixel(view.across, pixels.x), ray_of_pixel(view.downwards, pixels.y),
                        ray_of_pixel(view.across, pixels.z), ray_of_pixel(view.downwards, pixels.w)) / float(kTile);
    if (near < 1.01 * kNearest * view.eye.w) covered = vec4(0.0, 0.0, tiles);  // the eye is in or at the box
    // Boxes are extended by half a thousandth of a tile, for rounding.
    const ivec2 first = ivec2(clamp(floor(covered.xy - 5e-4), vec2(0.0), tiles));
    const ivec2 last = ivec2(clamp(floor(covered.zw + 5e-4), vec2(-1.0), tiles - 1.0));
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
            const uint at = 2u * ((v * push.tiles_down + uint(y)) * push.tiles_across + uint(x));
            // Most boxes change nothing, and a read costs less than an atomic. Words only fall, so one that was read
            // too early costs an atomic, and nothing else.
            if (tile_ranges[at] > floatBitsToUint(near)) atomicMin(tile_ranges[at], floatBitsToUint(near));
            if (tile_ranges[at + 1u] > ~floatBitsToUint(far)) atomicMin(tile_ranges[at + 1u], ~floatBitsToUint(far));
        }
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint node = group * kSliceGroup + gl_LocalInvocationID.x;
    if (node >= push.nodes) return;
    const uvec2 live = FETCH(nodes, int(push.node_base + node)).xy;
    const uvec2 leaves = node < push.whole_from ? live & ~FETCH(node_cells, int(node)).xy : live;
    if (leaves == uvec2(0u)) return;
    const uvec2 position = FETCH(node_positions, int(node)).xy;
    const vec3 corner = 4.0 * vec3(position.x & 0xffffu, position.x >> 16u, position.y & 0xffffu);
    const vec3 cell = push.box_size.xyz / float(4u << (2u * (position.y >> 16u)));
    const Box cells = cells_box(leaves);
    const Box box = Box(push.box_min.xyz + (corner + cells.low) * cell,
                        push.box_min.xyz + (corner + cells.high) * cell);
    for (uint v = 0u; v < push.views; ++v) store_range(v, box);
}
