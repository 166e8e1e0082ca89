// Keys of pairs of a tile and a leaf (shared/leaf_raster.h). The file that includes this one defines kNodeLevels.
#ifndef NEUVV_LEAF_KEY_GLSL
#define NEUVV_LEAF_KEY_GLSL

const uint kFinestDepth = 2u * kNodeLevels;
const uint kNearnessBits = 3u * kFinestDepth;

// A leaf as the cell of its own size, of which the box has 2^depth a side.
struct LeafCell {
    uvec3 at;
    uint depth;
};

// From a position of Field::leaf_positions.
LeafCell leaf_cell(uvec2 position) {
    return LeafCell(uvec3(position.x & 0xffffu, position.x >> 16u, position.y & 0xffffu), position.y >> 16u);
}

// The cells of an octree are in front-to-back order from an eye where the octants of every node are taken by increasing
// number, with the bit of an axis flipped where the eye is beyond the node's centre plane: a ray crosses that plane at
// most once, and only away from the eye's side. This function returns the index of a cell along one axis with its bits
// flipped that way. The leading bits that the cell shares with the eye's cell belong to nodes around both, and become
// 0. The first bit that differs says on which side of all further planes the eye is.
uint bits_from_eye(uint at, uint eye) {
    if (at == eye) return 0u;
    const uint differs = 1u << findMSB(at ^ eye);
    return differs | ((at > eye ? at : ~at) & (differs - 1u));
}

// Moves the bits of a number of 10 bits three apart.
uint spread(uint bits) {
    bits = (bits | bits << 16u) & 0x030000ffu;
    bits = (bits | bits << 8u) & 0x0300f00fu;
    bits = (bits | bits << 4u) & 0x030c30c3u;
    return (bits | bits << 2u) & 0x09249249u;
}

uint morton(uvec3 cell) { return spread(cell.x) | spread(cell.y) << 1u | spread(cell.z) << 2u; }

// The nearness of a leaf as (low word, high word): its Morton number, bits flipped as above. `eye`: the finest cell of
// the eye.
uvec2 nearness(LeafCell leaf, uvec3 eye) {
    const uint shift = kFinestDepth - leaf.depth;
    const uvec3 from_eye = uvec3(bits_from_eye(leaf.at.x, eye.x >> shift), bits_from_eye(leaf.at.y, eye.y >> shift),
                             bits_from_eye(leaf.at.z, eye.z >> shift)) << shift;
    const uint above = morton(from_eye >> 10u);
    return uvec2(morton(from_eye & 1023u) | above << 30u, above >> 2u);
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
