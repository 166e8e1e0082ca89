// The debug buffer: shaders append records to it (debug.glsl), and the host reads them when the work is done.
#ifndef NEUVV_SHARED_DEBUG_H
#define NEUVV_SHARED_DEBUG_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kDebugBinding = 63u;  // the same in every shader that includes debug.glsl
CONSTEXPR uint kMaxDebugRecords = 4096u;
CONSTEXPR uint kDebugAssert = 0x80000000u;  // the bit of a code that marks a failed assertion

struct DebugRecord {
    uint code;  // any number that the shader chooses, for instance __LINE__
    uint x;     // gl_GlobalInvocationID
    uint y;
    uint z;
    uvec4 words;
};

struct DebugHeader {
    uint count;  // of appended records, including those beyond kMaxDebugRecords, which are lost
    uint pad0;
    uint pad1;
    uint pad2;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::DebugRecord) == 32);
static_assert(sizeof(neuvv::DebugHeader) == 16);
#endif
#endif
