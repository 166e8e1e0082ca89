// Paint on a slice, first half: the densities. It runs after slice_density.comp has computed σ of all leaves, and
// changes σ of leaves with edits that apply at this time. A leaf that becomes live by paint takes a slot. A leaf whose
// σ becomes 0 is taken out of the masks of live cells; its slot is then ignored.
// Reads edits (20 bytes each, those of a leaf one after the other); reads and writes head, live cells and count. One
// thread per painted leaf. Bound by memory: 16 bytes per edit, 60 per leaf whose density changes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/paint.h"
#include "shared/slice.h"

layout(local_size_x = kSliceGroup) in;
READ_ARRAY(uvec2, kPaintLeaves, painted_leaves);
READ_ARRAY(uvec4, kPaintEdits, edits);
READ_ARRAY(uint, kPaintSigmas, edit_sigmas);
layout(binding = kPaintLayers) uniform utextureBuffer layers;
UPDATE_ARRAY(uvec2, kPaintHead, head);
WRITE_ARRAY(uint, kPaintSlots, slot_leaf);
layout(binding = kPaintLive, std430) buffer Live { LiveCount live; };
READ_ARRAY(uvec2, kPaintCells, leaf_cells);
layout(binding = kPaintNodeLive, std430) buffer NodeLive { uint node_live[]; };
layout(push_constant) uniform Push { PaintPush push; };
#include "slice/paint_edits.glsl"

// Takes a slot for a leaf; false where there is no room.
bool take_slot(uint leaf, out uint slot) {
    slot = atomicAdd(live.slots, 1u);
    if (slot >= push.capacity) {
        atomicAdd(live.overflow, 1u);
        return false;
    }
    atomicMax(live.groups_x, slot / kSliceGroup + 1u);
    STORE(slot_leaf, int(slot), uvec4(leaf));
    return true;
}

void set_sigma(uint leaf, float sigma) {
    const uvec2 before = LOAD(head, int(leaf)).xy;
    const bool lived = uintBitsToFloat(before.x) > 0.0, lives = sigma > 0.0;
    const uvec2 cells = FETCH(leaf_cells, int(leaf)).xy;
    uint slot = before.y;
    if (lives && !lived) {
        if (!take_slot(leaf, slot)) return;
        atomicOr(node_live[cells.x], cells.y);
    }
    if (lived && !lives) atomicAnd(node_live[cells.x], ~cells.y);
    STORE(head, int(leaf), uvec4(floatBitsToUint(sigma), slot, 0u, 0u));
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint at = group * kSliceGroup + gl_LocalInvocationID.x;
    if (at >= push.leaves) return;
    const uvec2 painted = FETCH(painted_leaves, int(at)).xy;  // the leaf, its first edit
    const uint end = FETCH(painted_leaves, int(at + 1u)).y;
    float sigma = 0.0;
    bool changed = false;
    for (uint i = painted.y; i < end; ++i) {
        Edit edit;
        if (!edit_applies(i, edit) || edit.sigma < 0.0) continue;
        if (!changed) sigma = uintBitsToFloat(LOAD(head, int(painted.x)).x);
        sigma = mix(sigma, edit.sigma, edit.opacity);
        changed = true;
    }
    if (changed) set_sigma(painted.x, sigma);
}
