// Walks one ray through the octree, front to back. march_enter reads the node that the walk has come to, march_cell
// goes from cell to cell within it, march_leaf from leaf to leaf within it, and march_next from leaf to leaf of the
// tree.
//
//   while (march_enter(march))            while (march_enter(march))                  while (march_next(march, part)) …
//       while (march.in_node)                 while (march_leaf(march, part)) …
//           if (march_cell(march, part)) …
//
// Inside a node the masks stay in registers, so that a step over an empty cell is arithmetic. The lanes of a SIMD
// device run the loops together, and lavapipe does not even branch around an `if` that no lane takes. So which way is
// the fastest depends on what a sample costs. On the left no lane waits for another within a node, but a sample is paid
// for at every empty cell: for samples that cost no more than a step. In the middle all lanes step over empty cells
// until each has a leaf or has left its node; then all sample. On the right they also go on to the next node before
// they sample, so that a descent is paid for with every sample: for samples that cost more than a descent.
//
// Positions are integers in finest cells, so the walk needs no epsilon: leaving a cell through one face fixes that axis
// exactly, the other axes are clamped to the cell that was left. Bound by the dependent texel fetches of march_enter:
// one, and three per node level below the top grid. Expects binding `tree_links`, `push.top` (a TopBox), and the
// constants kNodeLevels and kTopLevels. For comparison, an includer that defines OTHER_WALK has three more, which say
// what its walk does without: kRestart keeps nothing of the node over a step, kFromRoot descends from the root, not
// from the grid (both: the paper's walk), kCoalesce unset steps over every empty cell alone.
#ifndef NEUVV_MARCH_GLSL
#define NEUVV_MARCH_GLSL
#include "arrays.glsl"

#include "trace/node.glsl"

#ifndef OTHER_WALK
const bool kRestart = false, kFromRoot = false, kCoalesce = true;
#endif

// The includer's: the node, a child of one (with kLeafBit set a leaf), and whether the walk shall stop at this leaf.
Node march_node(uint node);
uint march_child(uint index);
bool march_wants(uint leaf);

// A walk goes up along every axis: those along which its ray goes down are mirrored, coordinates x as side − x and
// cells with all bits turned over.
struct March {
    vec3 origin;     // in finest cells
    vec3 direction;  // finest cells per metre, none below 0
    vec3 inverse;
    ivec3 mirror;  // per axis 0, or all bits of a cell
    uint mirror_bit;  // the same of a node's cells: bits of their Morton number
    ivec3 cell;    // the finest cell that the walk is in
    float t;       // metres along the ray
    float t_end;
    Node node;
    int shift;     // log2 of the side of the node's cells, in finest cells
    bool in_node;  // the walk has not left the node
    uint steps;    // nodes that it has come to, and leaves
};

// The part of a ray inside one leaf, in metres along the ray.
struct MarchInterval {
    float t_in, t_out;
    int shift;  // log2 of the leaf's side, in finest cells
};

const int kTopShift = int(2u * (kNodeLevels - kTopLevels));  // log2 of the side of the grid's cells, in finest cells

uvec3 top_low() { return uvec3(push.top.first) >> uvec3(0u, 10u, 20u) & 1023u; }
uvec3 top_size() { return (uvec3(push.top.last) >> uvec3(0u, 10u, 20u) & 1023u) + 1u - top_low(); }

// The box of all leaves, as the walk has its cells.
struct MarchBox {
    ivec3 low, high;
};
MarchBox march_box(March march) {
    const ivec3 first = ivec3(top_low() << kTopShift), end = ivec3((top_low() + top_size()) << kTopShift);
    const bvec3 down = notEqual(march.mirror, ivec3(0));
    return MarchBox(mix(first, march.mirror + 1 - end, down), mix(end, march.mirror + 1 - first, down));
}

// Slab test against it. Empty (x > y) where the ray misses it or it lies behind.
vec2 march_range(March march) {
    const MarchBox box = march_box(march);
    const vec3 near = (vec3(box.low) - march.origin) * march.inverse;
    const vec3 far = (vec3(box.high) - march.origin) * march.inverse;
    return vec2(max(max(near.x, near.y), max(near.z, 0.0)), min(far.x, min(far.y, far.z)));
}

// The walk of a ray between `range.x` and `range.y` metres; it ends at the first leaf border beyond them.
March march_begin(vec3 origin_tree, vec3 direction_tree, vec2 range) {
    const int side = 1 << (2u * kNodeLevels);
    March ray;
    const bvec3 down = lessThan(direction_tree, vec3(0.0));
    ray.origin = mix(origin_tree, 1.0 - origin_tree, down) * float(side);
    ray.direction = abs(direction_tree) * float(side);
    ray.mirror = ivec3(down) * (side - 1);
    ray.mirror_bit = (down.x ? 9u : 0u) | (down.y ? 18u : 0u) | (down.z ? 36u : 0u);
    ray.inverse = 1.0 / max(ray.direction, vec3(1e-20));  // so small a component never leaves a cell
    const vec2 inside = march_range(ray);
    ray.t = max(inside.x, range.x);
    ray.t_end = min(inside.y, range.y);
    const MarchBox box = march_box(ray);
    ray.cell = clamp(ivec3(floor(ray.origin + ray.direction * ray.t)), box.low, box.high - 1);
    ray.in_node = false;
    ray.steps = 0u;
    return ray;
}

// In the grid's cells, from its first one. Those before it wrap around, and lie behind the last; so do those beyond the
// tree, whose higher bits no mirror turns over.
uvec3 march_top(March ray) { return uvec3((ray.cell ^ ray.mirror) >> kTopShift) - top_low(); }

// Which of the node's cells the walk is in: its Morton number.
uint march_bit(March ray) {
    const uvec3 cell = uvec3(ray.cell >> ray.shift) & 3u;
    const uvec3 spread = (cell & 1u) | (cell & 2u) << 2u;
    return (spread.x | spread.y << 1u | spread.z << 2u) ^ ray.mirror_bit;
}

// Reads the deepest node around the walk's cell. False: the ray has ended.
bool march_enter(inout March ray) {
    const uvec3 at = march_top(ray), size = top_size();
    if (any(greaterThanEqual(at, size)) || ray.t >= ray.t_end) return false;
    uint top = (kNodeLevels - 1u) << kTopLevelShift;  // the root
    if (!kFromRoot) top = FETCH(tree_links, int((at.z * size.y + at.y) * size.x + at.x)).x;
    ray.shift = 2 * int(top >> kTopLevelShift);
    ray.node = march_node(top & ((1u << kTopLevelShift) - 1u));
    for (uint level = kNodeLevels - (kFromRoot ? 0u : kTopLevels); level > 1u; --level) {
        const uint bit = march_bit(ray);
        if (ray.shift == 0 || !node_lives(ray.node, bit)) break;
        const uint child = march_child(node_child(ray.node, bit));
        if ((child & kLeafBit) != 0u) break;
        ray.node = march_node(child);
        ray.shift -= 2;
    }
    ray.in_node = true;
    ++ray.steps;
    return true;
}

// Leaves the cell of side 2^shift around the walk; returns where, in metres.
float march_step(inout March ray, int shift) {
    const ivec3 low = (ray.cell >> shift) << shift, high = low + (1 << shift);
    const vec3 faces = (vec3(high) - ray.origin) * ray.inverse;
    const float t_out = min(faces.x, min(faces.y, faces.z));
    ray.t = max(ray.t, t_out);
    const ivec3 at = ivec3(floor(ray.origin + ray.direction * ray.t));
    const ivec3 left = ray.cell;
    ray.cell = mix(clamp(at, low, high - 1), high, lessThanEqual(faces, vec3(t_out)));
    const ivec3 moved = (ray.cell ^ left) >> (ray.shift + 2);
    ray.in_node = !kRestart && (moved.x | moved.y | moved.z) == 0;
    return t_out;
}

// log2 of the side of what is empty around an empty cell, in cells: perhaps the whole octant is, or the whole node.
int march_empty(March ray, uint bit) {
    const uint octant = (bit < 32u ? ray.node.live.x : ray.node.live.y) >> (bit & 24u) & 0xffu;
    return !kCoalesce || octant != 0u ? 0 : ray.node.live == uvec2(0u) ? 2 : 1;
}

// Goes on to the next live cell of the node, or stays in one. False: it has left the node.
bool march_find(inout March ray, out uint bit) {
    while (ray.in_node) {
        bit = march_bit(ray);
        if (node_lives(ray.node, bit)) return true;
        march_step(ray, ray.shift + march_empty(ray, bit));
    }
    return false;
}

// The ray's part in the node's next wanted leaf. False where there is none, or where a finer node comes first.
bool march_leaf(inout March ray, out MarchInterval interval) {
    uint bit;
    while (march_find(ray, bit)) {
        const uint child = march_child(node_child(ray.node, bit));
        if ((child & kLeafBit) == 0u) return false;
        interval.t_in = ray.t;
        interval.shift = ray.shift + (node_wide(ray.node, bit) ? 1 : 0);
        interval.t_out = march_step(ray, interval.shift);
        if (interval.t_out <= interval.t_in) continue;
        ++ray.steps;
        if (march_wants(child & ~kLeafBit)) return true;
    }
    return false;
}

// Goes over one cell of the node, or over empty ones around it. True where that was a wanted leaf.
bool march_cell(inout March ray, out MarchInterval interval) {
    const uint bit = march_bit(ray);
    const bool lives = node_lives(ray.node, bit);
    const int empty = march_empty(ray, bit);  // by all lanes, as a branch here was slower
    const uint child = lives ? march_child(node_child(ray.node, bit)) : 0u;
    const bool leaf = (child & kLeafBit) != 0u;
    if (lives && !leaf) {
        ray.in_node = false;
        return false;
    }
    interval.t_in = ray.t;
    interval.shift = ray.shift + (!lives ? empty : node_wide(ray.node, bit) ? 1 : 0);
    interval.t_out = march_step(ray, interval.shift);
    if (!leaf || interval.t_out <= interval.t_in) return false;
    ++ray.steps;
    return march_wants(child & ~kLeafBit);
}

// The ray's part in the next wanted leaf of the tree. False: there is none.
bool march_next(inout March ray, out MarchInterval interval) {
    bool found = false;
    do found = march_leaf(ray, interval);
    while (!found && march_enter(ray));
    return found;
}

#endif
