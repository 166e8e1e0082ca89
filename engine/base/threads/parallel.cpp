#include "base/threads/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace neuvv {

void parallel_for(size_t count, size_t grain, const std::function<void(size_t, size_t)>& run) {
    grain = std::max<size_t>(grain, 1);
    std::atomic<size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto work = [&] {
        for (;;) {
            const size_t begin = next.fetch_add(grain);
            if (begin >= count) return;
            try {
                run(begin, std::min(begin + grain, count));
            } catch (...) {
                const std::lock_guard lock(failure_mutex);
                if (!failure) failure = std::current_exception();
                next = count;
            }
        }
    };
    const size_t pieces = (count + grain - 1) / grain;
    const size_t threads = std::min<size_t>(pieces, std::max(1u, std::thread::hardware_concurrency()));
    std::vector<std::thread> helpers;
    for (size_t i = 1; i < threads; ++i) helpers.emplace_back(work);
    work();
    for (std::thread& helper : helpers) helper.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace neuvv
