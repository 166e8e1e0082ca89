// Printing and assertions for compute shaders, on any device. Include this file in a shader and call debug_print or
// debug_assert: the program then binds the buffer, and `neuvv render` and the tests report what was appended.
//
//   debug_print(__LINE__, uvec4(node, floatBitsToUint(sigma), 0, 0));
//   debug_assert(leaf < leaf_count, __LINE__, uvec4(leaf, 0, 0, 0));
#include "shared/debug.h"

layout(binding = kDebugBinding, std430) buffer DebugBuffer {
    DebugHeader debug_head;
    DebugRecord debug_records[];
};

void debug_print(uint code, uvec4 words) {
    const uint at = atomicAdd(debug_head.count, 1u);
    if (at >= kMaxDebugRecords) return;
    const uvec3 id = gl_GlobalInvocationID;
    debug_records[at] = DebugRecord(code, id.x, id.y, id.z, words);
}

void debug_assert(bool holds, uint code, uvec4 words) {
    if (!holds) debug_print(code | kDebugAssert, words);
}
