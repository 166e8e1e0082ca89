// Work shared out over the machine's cores.
#pragma once

#include <cstddef>
#include <functional>

namespace neuvv {

// Calls run(begin, end) for pieces of at most `grain` of [0, count) on all cores, and waits. The first exception of a
// piece is thrown again here, after the other pieces under way have ended.
void parallel_for(size_t count, size_t grain, const std::function<void(size_t begin, size_t end)>& run);

}  // namespace neuvv
