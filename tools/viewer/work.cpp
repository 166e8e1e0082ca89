#include "tools/viewer/work.h"

#include <exception>
#include <utility>

namespace neuvv::viewer {

Work::Work(std::function<void(const std::string&)> failed, std::function<void()> wake)
    : failed_(std::move(failed)), wake_(std::move(wake)), thread_([this] { run(); }) {}

Work::~Work() {
    stop();
}

void Work::stop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Work::start(std::string title, Job job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.emplace_back(std::move(title), std::move(job));
    }
    changed_.notify_all();
}

void Work::tell(Then then) {
    {
        const std::lock_guard lock(mutex_);
        told_.push_back(std::move(then));
    }
    wake_();
}

void Work::run_told() {
    std::vector<Then> told;
    {
        const std::lock_guard lock(mutex_);
        told.swap(told_);
    }
    for (const Then& then : told) then();
}

bool Work::has_told() const {
    const std::lock_guard lock(mutex_);
    return !told_.empty();
}

std::vector<std::string> Work::under_way() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> titles;
    for (const auto& [title, job] : jobs_)
        if (!title.empty()) titles.push_back(title);
    return titles;
}

bool Work::idle() const {
    const std::lock_guard lock(mutex_);
    return jobs_.empty();
}

void Work::run() {
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
            if (jobs_.empty()) return;
            job = jobs_.front().second;
        }
        try {
            if (Then then = job()) tell(std::move(then));
        } catch (const std::exception& error) {
            tell([this, text = std::string(error.what())] { failed_(text); });
        }
        {
            const std::lock_guard lock(mutex_);
            jobs_.pop_front();
        }
        wake_();
    }
}

}  // namespace neuvv::viewer
