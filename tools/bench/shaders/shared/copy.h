// The copy from buffer to buffer by which neuvv-bench measures a device's memory.
#ifndef NEUVV_BENCH_COPY_H
#define NEUVV_BENCH_COPY_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kCopyGroup = 256u, kCopyOfThread = 4u;  // threads of a workgroup, and 16-byte vectors of a thread

CONSTEXPR uint kCopyFrom = 0u;
CONSTEXPR uint kCopyTo = 1u;

struct CopyPush {
    uint vectors;
};

NEUVV_SHARED_END
#endif
