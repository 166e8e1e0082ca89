// Walks one ray through the octree, front to back, and calls march_visit for every leaf on its way.
//
// Positions are integers in finest cells, so the walk needs no epsilon: leaving a cell through one face fixes that axis
// exactly, the other axes are clamped to the cell that was left. Bound by dependent texel fetches (two per node level).
// Expects bindings `tree_nodes` and `tree_children`, and the specialisation constant kNodeLevels.
#ifndef NEUVV_MARCH_GLSL
#define NEUVV_MARCH_GLSL

// The includer's: the leaf and the segment [t_in, t_out] in metres along the ray; false ends the walk.
bool march_visit(uint leaf, float t_in, float t_out);

struct March {
    vec3 origin;     // in finest cells
    vec3 direction;  // finest cells per metre
    vec3 inverse;
};

// Slab test against the whole tree. Empty (x > y) where the ray misses it or it lies behind.
vec2 march_range(March march) {
    const float side = float(1u << (2u * kNodeLevels));
    const vec3 a = -march.origin * march.inverse, b = (side - march.origin) * march.inverse;
    const vec3 near = min(a, b), far = max(a, b);
    return vec2(max(max(near.x, near.y), max(near.z, 0.0)), min(far.x, min(far.y, far.z)));
}

// The largest known cell around q: its leaf, or kNoLeaf where it is empty. `shift`: log2 of its side.
const uint kNoLeaf = 0xffffffffu;

uint march_cell(ivec3 q, out uint shift) {
    uint node = 0u;
    for (uint level = kNodeLevels; level-- > 0u;) {
        shift = 2u * level;
        const uvec3 cell = uvec3(q >> int(shift)) & 3u;
        const uvec3 high = cell >> 1u, low = cell & 1u;
        const uint octant = high.x | high.y << 1u | high.z << 2u;
        const uint bit = octant << 3u | low.x | low.y << 1u | low.z << 2u;
        const uvec4 entry = texelFetch(tree_nodes, int(node));
        const uint word = octant < 4u ? entry.x : entry.y;
        const uint in_word = bit & 31u;
        if ((word >> in_word & 1u) == 0u) {
            if ((word >> (in_word & 24u) & 0xffu) == 0u) shift += 1u;  // the whole octant is empty
            return kNoLeaf;
        }
        const uint below = bitCount(word & ((1u << in_word) - 1u)) + (octant < 4u ? 0u : bitCount(entry.x));
        const uint child = texelFetch(tree_children, int(entry.z + below)).x;
        if ((child & kLeafBit) != 0u) {
            if ((child & kWideLeafBit) != 0u) shift += 1u;
            return child & kLeafIndexMask;
        }
        node = child;
    }
    return kNoLeaf;  // a well-formed tree ends in leaves
}

void march(vec3 origin_tree, vec3 direction_tree) {
    const int side = 1 << (2u * kNodeLevels);
    March ray;
    ray.origin = origin_tree * float(side);
    ray.direction = direction_tree * float(side);
    // So small a component never leaves a cell, and its inverse stays finite.
    const vec3 safe = mix(ray.direction, vec3(1e-20), lessThan(abs(ray.direction), vec3(1e-20)));
    ray.inverse = 1.0 / safe;
    const vec2 range = march_range(ray);
    float t = range.x;
    if (t >= range.y) return;

    ivec3 q = clamp(ivec3(floor(ray.origin + ray.direction * t)), 0, side - 1);
    const ivec3 forward = ivec3(greaterThan(safe, vec3(0.0)));
    while (true) {
        uint shift;
        const uint leaf = march_cell(q, shift);
        const ivec3 low = (q >> int(shift)) << int(shift);
        const int size = 1 << shift;
        const vec3 faces = (vec3(low + forward * size) - ray.origin) * ray.inverse;
        const float t_out = min(faces.x, min(faces.y, faces.z));
        if (leaf != kNoLeaf && t_out > t && !march_visit(leaf, t, t_out)) return;
        t = max(t, t_out);
        const ivec3 at = ivec3(floor(ray.origin + ray.direction * t));
        const bvec3 leaves = lessThanEqual(faces, vec3(t_out));
        const ivec3 beyond = low - 1 + forward * (size + 1);
        q = mix(clamp(at, low, low + size - 1), beyond, leaves);
        if (any(lessThan(q, ivec3(0))) || any(greaterThanEqual(q, ivec3(side)))) return;
    }
}

#endif
