// The debug buffer: records that shaders append with debug.glsl and the host reads when the work is done.
#ifndef NEUVV_SHARED_DEBUG_H
#define NEUVV_SHARED_DEBUG_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kDebugBinding = 63u;  // of every shader that includes debug.glsl
CONSTEXPR uint kMaxDebugRecords = 4096u;
CONSTEXPR uint kDebugAssert = 0x80000000u;  // this bit of a code: an assertion failed

struct DebugRecord {
    uint code;  // whatever the shader said, __LINE__ for instance
    uint x;     // gl_GlobalInvocationID
    uint y;
    uint z;
    uvec4 words;
};

struct DebugHead {
    uint count;  // of records that were appended, also of those that found no room
    uint pad0;
    uint pad1;
    uint pad2;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::DebugRecord) == 32);
static_assert(sizeof(neuvv::DebugHead) == 16);
#endif
#endif
