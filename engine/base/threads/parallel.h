// Work divided among the processor's cores.
#pragma once

#include <cstddef>
#include <functional>

namespace neuvv {

// Calls run(begin, end) for parts of [0, count) of at most `grain` elements, on all cores, and waits. The first
// exception of a part is thrown again here, once the other running parts have ended.
void parallel_for(size_t count, size_t grain, const std::function<void(size_t begin, size_t end)>& run);

}  // namespace neuvv
