// A few threads that finish tasks while the caller makes more of them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace neuvv::training {

class Workers {
  public:
    // add() blocks while `pending` tasks wait: it bounds the memory that they hold.
    Workers(uint32_t threads, size_t pending);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // Both rethrow the first exception of a task; the tasks after it are dropped.
    void add(std::function<void()> task);
    void finish();

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

}  // namespace neuvv::training
