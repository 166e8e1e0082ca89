// Parts of one performer in red: each entry of a slice tree belongs to the bone whose surface is nearest, and the
// shaded entries of a bone are tinted.
#ifndef NEUVV_SHARED_HIGHLIGHT_H
#define NEUVV_SHARED_HIGHLIGHT_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kMaxBones = 24u;
CONSTEXPR uint kNoBone = 255u;            // of entries of child nodes, and of padding
CONSTEXPR float kHighlightShare = 0.95f;  // of red in a leaf that is tinted wholly

// A line with a thickness. Performer's space, metres.
struct ShaderBone {
    vec4 from;  // w: radius
    vec4 to;
};

struct ShaderBones {
    ShaderBone bones[kMaxBones];
};

// bind_bones.comp
CONSTEXPR uint kBindBones = 0u;      // ShaderBones
CONSTEXPR uint kBindLeaves = 1u;     // per entry: its leaf, or kNoLeaf
CONSTEXPR uint kBindPositions = 2u;  // per leaf: as Field::leaf_positions
CONSTEXPR uint kBindCount = 3u;      // per slice: a LiveCount of entries
CONSTEXPR uint kBindOut = 4u;        // per slice, bone_words words: the bones of four entries each

struct BindBonesPush {
    vec4 box_min;   // metres
    vec4 box_size;  // metres
    uint slice;
    uint capacity;    // number of entries for which a slice has room
    uint bone_words;  // of a slice: a quarter of the capacity, rounded up
    uint bones;
};

// highlight.comp: kBindCount, and
CONSTEXPR uint kHighlightBones = 0u;   // as kBindOut
CONSTEXPR uint kHighlightShaded = 1u;  // shaded entries, read and written

struct HighlightPush {
    uint tints[kMaxBones / 4u];  // 0..255 of each bone
    uint slice;
    uint capacity;
    uint bone_words;
    uint view;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ShaderBones) == 32 * neuvv::kMaxBones);
static_assert(sizeof(neuvv::BindBonesPush) == 48);
static_assert(sizeof(neuvv::HighlightPush) == 40);
#endif
#endif
