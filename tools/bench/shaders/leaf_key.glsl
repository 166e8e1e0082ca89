// Keys of pairs (shared/leaf_raster.h). The includer sets kNodeLevels.
#ifndef NEUVV_LEAF_KEY_GLSL
#define NEUVV_LEAF_KEY_GLSL

const uint kFinestDepth = 2u * kNodeLevels;
const uint kNearnessBits = 3u * kFinestDepth;

// A leaf's place as the cell of its own size, 2^depth a side of the box.
struct LeafCell {
    uvec3 at;
    uint depth;
};

LeafCell leaf_cell(uvec2 place) {
    return LeafCell(uvec3(place.x & 0xffffu, place.x >> 16u, place.y & 0xffffu), place.y >> 16u);
}

// An octree's cells lie front to back from an eye where every node's octants are taken by increasing number, the bit of an
// axis flipped where the eye is beyond the node's middle plane: a ray passes that plane once at most, and only away from
// the eye's side. So this is the place along one axis, each bit flipped where the eye is beyond the plane that it tells
// the sides of. Nodes around the eye's own cell have its bits: these cancel. The first bit that differs says on which side
// of all planes below it the eye is.
uint bits_from_eye(uint at, uint eye) {
    if (at == eye) return 0u;
    const uint differs = 1u << findMSB(at ^ eye);
    return differs | ((at > eye ? at : ~at) & (differs - 1u));
}

// Bits of a number of 10, three apart.
uint spread(uint bits) {
    bits = (bits | bits << 16u) & 0x030000ffu;
    bits = (bits | bits << 8u) & 0x0300f00fu;
    bits = (bits | bits << 4u) & 0x030c30c3u;
    return (bits | bits << 2u) & 0x09249249u;
}

uint morton(uvec3 place) { return spread(place.x) | spread(place.y) << 1u | spread(place.z) << 2u; }

// Of a leaf, in (low, high) words: its Morton number as the eye's cell, of the finest, has it.
uvec2 nearness(LeafCell leaf, uvec3 eye) {
    const uint shift = kFinestDepth - leaf.depth;
    const uvec3 seen = uvec3(bits_from_eye(leaf.at.x, eye.x >> shift), bits_from_eye(leaf.at.y, eye.y >> shift),
                             bits_from_eye(leaf.at.z, eye.z >> shift)) << shift;
    const uint above = morton(seen >> 10u);
    return uvec2(morton(seen & 1023u) | above << 30u, above >> 2u);
}

uvec2 pair_key(uint tile, uvec2 nearness) {
    if (kNearnessBits >= 32u) return uvec2(nearness.x, nearness.y | tile << (kNearnessBits & 31u));
    return uvec2(nearness.x | tile << kNearnessBits, tile >> (32u - kNearnessBits & 31u));
}

uint pair_tile(uvec2 key) {
    if (kNearnessBits >= 32u) return key.y >> (kNearnessBits & 31u);
    return key.x >> kNearnessBits | key.y << (32u - kNearnessBits & 31u);
}

#endif
