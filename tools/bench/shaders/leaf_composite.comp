// Composites the leaves of each listed tile front to back.
// Reads the sorted pairs, and the shaded entries and positions of their leaves; writes premultiplied linear RGB and
// alpha, and depth in metres, of each ray. One workgroup per tile, dispatched indirectly, one thread per pixel. The
// threads fetch 64 leaves together, and set each leaf's bit for the columns and rows of the tile that it covers. Then
// each thread takes the leaves whose bits are set for both its column and its row, until all rays of the tile have
// ended. Bound by the fetches, three of which depend on each other, and by arithmetic: a projection for each leaf of
// the tile, and some 30 operations for each of the leaf's pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/leaf_raster.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kNodeLevels = 4u;
layout(binding = kCompositePairs) uniform utextureBuffer tile_pairs;
layout(binding = kCompositeValues) uniform utextureBuffer pair_entries;
layout(binding = kCompositeEntries) uniform utextureBuffer shaded;
layout(binding = kCompositeLeaves) uniform utextureBuffer entry_leaf;
layout(binding = kCompositePositions) uniform utextureBuffer leaf_positions;
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
layout(binding = kTraceTileList) uniform utextureBuffer tile_list;
layout(binding = kTraceRadiance, rgba32f) writeonly uniform imageBuffer radiance;
layout(binding = kTraceDepth, r32f) writeonly uniform imageBuffer depth;
layout(push_constant) uniform Push { LeafRasterPush push; };
#include "trace/composite.glsl"
#include "leaf_pixels.glsl"

// The tile of this workgroup; kNoTile beyond the list, where there are no rays.
uint tile_group() { return texelFetch(tile_list, int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x)).x; }

vec2 tile_range(uint tile) { return vec2(0.0, 1e30); }

uint first_camera() { return 0u; }

float set_end(uint view, vec2 at) { return 1e30; }

#include "rays/ray.glsl"

shared vec4 leaf_box[kTilePixels];    // low corner and edge, in finest cells
shared vec4 leaf_light[kTilePixels];  // colour, σ (1/m)
// Per turn, axis, and column or row of pixels: a bit for each leaf that covers some of it.
shared uint covering[8u * kTile];
shared uint ended_rays;

// A ray in finest cells: its origin, and metres per finest cell along each axis.
struct CellRay {
    vec3 origin, inverse;
};

CellRay cell_ray(Ray ray) {
    const float side = float(1u << kFinestDepth);
    const vec3 direction = ray.direction / push.box_size.xyz * side;
    const vec3 safe = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
    return CellRay((ray.origin - push.box_min.xyz) / push.box_size.xyz * side, 1.0 / safe);
}

// The first of the two words of a column (axis 0) or row (axis 1).
uint line_of(uint turn, uint axis, uint at) { return 2u * (kTile * (2u * turn + axis) + at); }

// Fetches this thread's leaf of the turn. `corner`: the tile's first pixel.
void fetch_leaf(uint pair, uvec2 corner, uint turn) {
    const uint thread = gl_LocalInvocationID.x, word = thread / 32u, bit = 1u << (thread & 31u);
    const uint entry = texelFetch(pair_entries, int(pair)).x;
    const uvec2 words = texelFetch(shaded, int(entry)).xy;
    const uint leaf = texelFetch(entry_leaf, int(push.slice * push.entry_capacity + entry)).x;
    const LeafCell cell = leaf_cell(texelFetch(leaf_positions, int(leaf)).xy);
    const uint shift = kFinestDepth - cell.depth;
    const vec2 first_two = unpackHalf2x16(words.x);
    leaf_box[thread] = vec4(cell.at << shift, 1u << shift);
    leaf_light[thread] = vec4(first_two.y, unpackHalf2x16(words.y), first_two.x);
    const Pixels pixels = leaf_pixels(cell);
    const uvec2 first = max(pixels.first, corner) - corner, end = min(max(pixels.end, corner) - corner, uvec2(kTile));
    for (uint x = first.x; x < end.x; ++x) atomicOr(covering[line_of(turn, 0u, x) + word], bit);
    for (uint y = first.y; y < end.y; ++y) atomicOr(covering[line_of(turn, 1u, y) + word], bit);
}

// The fetched leaves that cover the thread's pixel: a bit for each.
uvec2 leaves_over(uint in_tile, uint turn) {
    const uint column = line_of(turn, 0u, in_tile % kTile), row = line_of(turn, 1u, in_tile / kTile);
    return uvec2(covering[column] & covering[row], covering[column + 1u] & covering[row + 1u]);
}

// Clears the lowest bit that is set, and returns its number.
uint next_leaf(inout uvec2 leaves) {
    const bool low = leaves.x != 0u;
    const uint at = low ? uint(findLSB(leaves.x)) : 32u + uint(findLSB(leaves.y));
    if (low) leaves.x &= leaves.x - 1u;
    else leaves.y &= leaves.y - 1u;
    return at;
}

void add_leaf(inout Composite sum, CellRay ray, vec4 box, vec4 light) {
    const vec3 a = (box.xyz - ray.origin) * ray.inverse, b = (box.xyz + box.w - ray.origin) * ray.inverse;
    const vec3 near = min(a, b), far = max(a, b);
    const float t_in = max(max(near.x, near.y), max(near.z, 0.0)), t_out = min(far.x, min(far.y, far.z));
    composite_add(sum, light.w, max(t_out - t_in, 0.0), light.rgb, 0.5 * (t_in + t_out));
}

void main() {
    if (tile_group() * kTilePixels >= uint(imageSize(radiance))) return;
    const Ray ray = tile_ray();
    const CellRay of_cells = cell_ray(ray);
    const uvec2 corner = texelFetch(tiles, int(tile_group())).yz, pairs = texelFetch(tile_pairs, int(tile_group())).xy;
    const uint thread = gl_LocalInvocationID.x;
    Composite sum = composite_begin();
    bool open = ray.range.x < ray.range.y;
    if (thread == 0u) ended_rays = 0u;
    covering[thread] = 0u;
    barrier();
    if (!open) atomicAdd(ended_rays, 1u);
    uint turn = 0u;
    for (uint first = pairs.x; first < pairs.y; first += kTilePixels, turn ^= 1u) {
        barrier();  // all threads are done with the leaves before
        const bool ended = ended_rays == kTilePixels;
        if (first + thread < pairs.y) fetch_leaf(first + thread, corner, turn);
        barrier();
        if (ended) break;
        if (thread < 4u * kTile) covering[line_of(turn ^ 1u, 0u, 0u) + thread] = 0u;
        uvec2 leaves = open ? leaves_over(ray.in_tile, turn) : uvec2(0u);
        while (leaves != uvec2(0u)) {
            const uint leaf = next_leaf(leaves);
            add_leaf(sum, of_cells, leaf_box[leaf], leaf_light[leaf]);
            if (sum.transmittance >= push.box_min.w) continue;
            open = false;
            leaves = uvec2(0u);
            atomicAdd(ended_rays, 1u);
        }
    }
    const float alpha = 1.0 - sum.transmittance;
    imageStore(radiance, int(ray.index), vec4(sum.colour, alpha));
    imageStore(depth, int(ray.index), vec4(alpha > 0.0 ? sum.depth / alpha : uintBitsToFloat(0x7f800000u)));
}
