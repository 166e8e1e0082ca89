#include "editor/waveforms.h"

#include <chrono>
#include <exception>
#include <utility>

#include "base/trace_file.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::editor {

namespace {

constexpr std::chrono::seconds kLookPeriod{1};  // between looks at files that may have changed

}  // namespace

Waveforms::~Waveforms() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    stop_source_.request_stop();
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Waveforms::follow(Files files) {
    {
        const std::lock_guard lock(mutex_);
        files_ = std::move(files);
        std::erase_if(known_, [this](const auto& known) { return !files_.contains(known.first); });
        if (!thread_.joinable() && !files_.empty()) thread_ = std::thread([this] { run(); });
        looks_now_ = true;
    }
    changed_.notify_all();
}

std::shared_ptr<const media::SoundPeaks> Waveforms::of(const std::filesystem::path& file) const {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(file);
    return known == known_.end() ? nullptr : known->second.peaks;
}

std::string Waveforms::take_problem() {
    const std::lock_guard lock(mutex_);
    if (problems_.empty()) return {};
    std::string problem = std::move(problems_.front());
    problems_.pop_front();
    return problem;
}

void Waveforms::run() {
    name_trace_thread("reads waveforms");
    std::unique_lock lock(mutex_);
    while (!stop_) {
        looks_now_ = false;
        const Files files = files_;
        lock.unlock();
        for (const std::filesystem::path& file : files) read_changed(file);
        lock.lock();
        const auto is_new = [this] { return stop_ || looks_now_; };
        if (files_.empty())
            changed_.wait(lock, is_new);
        else
            changed_.wait_for(lock, kLookPeriod, is_new);
    }
}

// Whether the file is still to be read.
bool Waveforms::is_wanted(const std::filesystem::path& file) const {
    const std::lock_guard lock(mutex_);
    return !stop_ && files_.contains(file);
}

void Waveforms::read_changed(const std::filesystem::path& file) {
    if (!is_wanted(file)) return;
    const FileStamp stamp = stamp_of(file);
    {
        const std::lock_guard lock(mutex_);
        const auto known = known_.find(file);
        if (known != known_.end() && known->second.stamp == stamp) return;
    }
    Known read{stamp, nullptr};
    std::string problem;
    try {
        auto peaks = media::read_sound_peaks(voctree::sound_here(file, stop_source_.get_token()),
                                             [&] { return is_wanted(file); });
        if (!peaks) return;
        read.peaks = std::make_shared<const media::SoundPeaks>(std::move(*peaks));
    } catch (const std::exception& error) {
        problem = error.what();
    }
    {
        const std::lock_guard lock(mutex_);
        if (stop_ || !files_.contains(file)) return;
        known_[file] = std::move(read);
        if (!problem.empty()) problems_.push_back(std::move(problem));
    }
    wake_();
}

}  // namespace neuvv::editor
