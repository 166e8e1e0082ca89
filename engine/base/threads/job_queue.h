// A queue of jobs on a thread of its own, so that the owner's thread never waits for a file. Jobs run one after the
// other; the function that a job returns runs on the owner's thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace neuvv {

class JobQueue {
  public:
    // What is done with a job's result, on the owner's thread. It may be empty.
    using Then = std::function<void()>;
    using Job = std::function<Then()>;

    // `failed` runs on the owner's thread with the text of what a job threw. `wake` is called from any thread when
    // something has been posted or a job has ended.
    JobQueue(std::function<void(const std::string&)> failed, std::function<void()> wake);
    ~JobQueue();
    JobQueue(const JobQueue&) = delete;
    JobQueue& operator=(const JobQueue&) = delete;

    // Waits for all jobs that were started. What they post is not run any more, unless run_posted is called.
    void stop();

    // `title` is shown to the user while the job waits or runs; an empty title shows nothing.
    void start(std::string title, Job job);
    // May be called from any thread: `then` will run on the owner's thread.
    void post(Then then);
    // The owner's thread calls this once a frame: it runs what was posted.
    void run_posted();
    bool has_posted() const;
    // The titles of the jobs that run or wait.
    std::vector<std::string> under_way() const;
    bool idle() const;

  private:
    void run();
    std::function<void(const std::string&)> failed_;
    std::function<void()> wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::pair<std::string, Job>> jobs_;  // the first one runs
    std::vector<Then> posted_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace neuvv
