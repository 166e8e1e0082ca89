#include "base/threads/job_queue.h"
#include "base/trace_file.h"

#include <exception>
#include <utility>

namespace neuvv {

JobQueue::JobQueue(std::function<void(const std::string&)> failed, std::function<void()> wake)
    : failed_(std::move(failed)), wake_(std::move(wake)), thread_([this] { run(); }) {}

JobQueue::~JobQueue() {
    stop();
}

void JobQueue::stop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void JobQueue::start(std::string title, Job job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.emplace_back(std::move(title), std::move(job));
    }
    changed_.notify_all();
}

void JobQueue::post(Then then) {
    {
        const std::lock_guard lock(mutex_);
        posted_.push_back(std::move(then));
    }
    wake_();
}

void JobQueue::run_posted() {
    std::vector<Then> posted;
    {
        const std::lock_guard lock(mutex_);
        posted.swap(posted_);
    }
    for (const Then& then : posted) then();
}

bool JobQueue::has_posted() const {
    const std::lock_guard lock(mutex_);
    return !posted_.empty();
}

std::vector<std::string> JobQueue::under_way() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> titles;
    for (const auto& [title, job] : jobs_)
        if (!title.empty()) titles.push_back(title);
    return titles;
}

bool JobQueue::idle() const {
    const std::lock_guard lock(mutex_);
    return jobs_.empty();
}

void JobQueue::run() {
    name_trace_thread("jobs");
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
            if (jobs_.empty()) return;
            job = jobs_.front().second;
        }
        try {
            if (Then then = job()) post(std::move(then));
        } catch (const std::exception& error) {
            post([this, text = std::string(error.what())] { failed_(text); });
        }
        {
            const std::lock_guard lock(mutex_);
            jobs_.pop_front();
        }
        wake_();
    }
}

}  // namespace neuvv
