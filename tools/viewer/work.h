// Work off the window's thread: files are read and written one after the other; what comes of it is told to the
// window's thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace neuvv::viewer {

class Work {
  public:
    // What is done with a job's result, on the window's thread.
    using Then = std::function<void()>;
    using Job = std::function<Then()>;

    // `failed`: on the window's thread, with what a job threw. `wake`: from any thread, when something is to be told.
    Work(std::function<void(const std::string&)> failed, std::function<void()> wake);
    ~Work();

    // Waits for the jobs that were begun or given; nothing more is done or told then.
    void stop();

    // `title` is what is shown meanwhile; empty: nothing.
    void start(std::string title, Job job);
    // From any thread: to be run on the window's.
    void tell(Then then);
    // On the window's thread, each frame.
    void run_told();
    bool has_told() const;
    // The titles of what is under way or waits.
    std::vector<std::string> under_way() const;
    bool idle() const;

  private:
    void run();
    std::function<void(const std::string&)> failed_;
    std::function<void()> wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::pair<std::string, Job>> jobs_;  // the first is under way
    std::vector<Then> told_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace neuvv::viewer
