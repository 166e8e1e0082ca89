// Appends to a list of tiles over which later passes are dispatched indirectly, in rows of kListRow workgroups. The
// includer binds uimageBuffer `list` and the LiveCount `count` in a storage buffer.
#ifndef NEUVV_APPEND_TILE_GLSL
#define NEUVV_APPEND_TILE_GLSL

void append_tile(uint tile) {
    const uint at = atomicAdd(count.slots, 1u);
    imageStore(list, int(at), uvec4(tile));
    atomicMax(count.groups_x, min(at + 1u, kListRow));
    atomicMax(count.groups_y, at / kListRow + 1u);
}

#endif
