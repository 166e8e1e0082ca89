// Walks one ray through the octree, front to back: march_next goes on to the next leaf that the includer wants.
//
// Two nested loops, walk and shade, keep the lanes of a SIMD device together: all of them walk until each has a leaf,
// then all shade. (lavapipe does not even branch around an `if` that no lane takes: shading inside the walk would be
// paid at every empty cell.)
//
// Positions are integers in finest cells, so the walk needs no epsilon: leaving a cell through one face fixes that axis
// exactly, the other axes are clamped to the cell that was left. Bound by dependent texel fetches (one, and two per node level below
// the top grid). Expects bindings `tree_top`, `tree_nodes` and `tree_children`, and the specialisation constant kNodeLevels.
#ifndef NEUVV_MARCH_GLSL
#define NEUVV_MARCH_GLSL

// The includer's: which of a node's cells may hold anything now (mask_lo, mask_hi), and whether this leaf does.
uvec2 march_cells(uint node);
bool march_wants(uint leaf);

struct March {
    vec3 origin;     // in finest cells
    vec3 direction;  // finest cells per metre
    vec3 inverse;
    ivec3 cell;   // the finest cell that the walk is in
    float t;      // metres along the ray
    bool inside;  // false: the walk has left the tree
};

// The part of a ray inside one leaf, in metres along the ray.
struct MarchSegment {
    float t_in, t_out;
};

// Slab test against the whole tree. Empty (x > y) where the ray misses it or it lies behind.
vec2 march_range(March march) {
    const float side = float(1u << (2u * kNodeLevels));
    const vec3 a = -march.origin * march.inverse, b = (side - march.origin) * march.inverse;
    const vec3 near = min(a, b), far = max(a, b);
    return vec2(max(max(near.x, near.y), max(near.z, 0.0)), min(far.x, min(far.y, far.z)));
}

// The largest known cell around q: its leaf, or kNoLeaf where it is empty. `shift`: log2 of its side.
uint march_cell(ivec3 q, out uint shift) {
    const uint top = top_levels(kNodeLevels);
    const ivec3 at = q >> int(2u * (kNodeLevels - top));
    const uvec2 begin = texelFetch(tree_top, at.x | at.y << int(2u * top) | at.z << int(4u * top)).xy;
    shift = begin.y;
    if (begin.x == kNoLeaf) return kNoLeaf;
    if ((begin.x & kLeafBit) != 0u) return begin.x & kLeafIndexMask;
    uint node = begin.x;
    for (uint level = kNodeLevels - top; level-- > 0u;) {
        shift = 2u * level;
        const uvec3 cell = uvec3(q >> int(shift)) & 3u;
        const uvec3 high = cell >> 1u, low = cell & 1u;
        const uint octant = high.x | high.y << 1u | high.z << 2u;
        const uint bit = octant << 3u | low.x | low.y << 1u | low.z << 2u;
        const uint in_word = bit & 31u;
        const uvec2 cells = march_cells(node);
        const uint here = octant < 4u ? cells.x : cells.y;
        if ((here >> in_word & 1u) == 0u) {
            // Perhaps the whole octant is empty, or the whole node.
            if ((here >> (in_word & 24u) & 0xffu) == 0u) shift += cells == uvec2(0u) ? 2u : 1u;
            return kNoLeaf;
        }
        const uvec4 entry = texelFetch(tree_nodes, int(node));
        const uint word = octant < 4u ? entry.x : entry.y;
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

March march_begin(vec3 origin_tree, vec3 direction_tree) {
    const int side = 1 << (2u * kNodeLevels);
    March ray;
    ray.origin = origin_tree * float(side);
    ray.direction = direction_tree * float(side);
    // So small a component never leaves a cell, and its inverse stays finite.
    const vec3 safe = mix(ray.direction, vec3(1e-20), lessThan(abs(ray.direction), vec3(1e-20)));
    ray.inverse = 1.0 / safe;
    const vec2 range = march_range(ray);
    ray.t = range.x;
    ray.inside = range.x < range.y;
    ray.cell = clamp(ivec3(floor(ray.origin + ray.direction * ray.t)), 0, side - 1);
    return ray;
}

// The ray's part in the next wanted leaf; false where there is none.
bool march_next(inout March ray, out MarchSegment segment) {
    const int side = 1 << (2u * kNodeLevels);
    const ivec3 forward = ivec3(greaterThan(ray.inverse, vec3(0.0)));
    bool found = false;
    while (ray.inside && !found) {
        uint shift;
        const uint leaf = march_cell(ray.cell, shift);
        const ivec3 low = (ray.cell >> int(shift)) << int(shift);
        const int size = 1 << shift;
        const vec3 faces = (vec3(low + forward * size) - ray.origin) * ray.inverse;
        const float t_out = min(faces.x, min(faces.y, faces.z));
        segment = MarchSegment(ray.t, t_out);
        if (leaf != kNoLeaf && t_out > ray.t) found = march_wants(leaf);
        ray.t = max(ray.t, t_out);
        const ivec3 at = ivec3(floor(ray.origin + ray.direction * ray.t));
        const ivec3 beyond = low - 1 + forward * (size + 1);
        ray.cell = mix(clamp(at, low, low + size - 1), beyond, lessThanEqual(faces, vec3(t_out)));
        ray.inside = all(greaterThanEqual(ray.cell, ivec3(0))) && all(lessThan(ray.cell, ivec3(side)));
    }
    return found;
}

#endif
