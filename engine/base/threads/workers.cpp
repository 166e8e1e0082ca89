#include "base/threads/workers.h"

#include <algorithm>
#include <utility>

#include "base/trace_file.h"

namespace neuvv {

Workers::Workers(uint32_t threads, size_t pending) : pending_(std::max<size_t>(1, pending)) {
    for (uint32_t i = 0; i < std::max(1u, threads); ++i) threads_.emplace_back([this] { run(); });
}

Workers::~Workers() {
    {
        const std::lock_guard lock(mutex_);
        closing_ = true;
        tasks_.clear();
    }
    task_added_.notify_all();
}

void Workers::add(std::function<void()> task) {
    std::unique_lock lock(mutex_);
    task_ended_.wait(lock, [&] { return failure_ || tasks_.size() < pending_; });
    if (failure_) std::rethrow_exception(failure_);
    tasks_.push_back(std::move(task));
    task_added_.notify_one();
}

void Workers::finish() {
    std::unique_lock lock(mutex_);
    task_ended_.wait(lock, [&] { return failure_ || (tasks_.empty() && running_ == 0); });
    if (failure_) std::rethrow_exception(failure_);
}

uint64_t Workers::finished() const {
    const std::lock_guard lock(mutex_);
    return finished_;
}

void Workers::run() {
    name_trace_thread("worker");
    std::unique_lock lock(mutex_);
    while (true) {
        task_added_.wait(lock, [&] { return closing_ || !tasks_.empty(); });
        if (tasks_.empty()) return;
        const std::function<void()> task = std::move(tasks_.front());
        tasks_.pop_front();
        ++running_;
        lock.unlock();
        std::exception_ptr failure;
        try {
            task();
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        --running_;
        ++finished_;
        if (failure) tasks_.clear();
        if (failure && !failure_) failure_ = failure;
        task_ended_.notify_all();
    }
}

}  // namespace neuvv
