// Threads that work on tasks while the caller adds more of them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace neuvv {

class Workers {
  public:
    // add() blocks while `pending` tasks wait, which bounds the memory that tasks take.
    Workers(uint32_t threads, size_t pending);
    // Drops the tasks that have not begun and waits for the others.
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // Both rethrow the first exception of a task; tasks that had not begun by then are dropped.
    void add(std::function<void()> task);
    // Waits until all tasks are done.
    void finish();

    // The number of tasks that have ended.
    uint64_t finished() const;

  private:
    void run();

    const size_t pending_;
    mutable std::mutex mutex_;
    std::condition_variable task_added_, task_ended_;
    std::deque<std::function<void()>> tasks_;
    uint64_t finished_ = 0, running_ = 0;
    bool closing_ = false;
    std::exception_ptr failure_;
    std::vector<std::jthread> threads_;
};

}  // namespace neuvv
