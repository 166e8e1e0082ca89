#include "editor/draw/render_queue.h"

#include <utility>

namespace neuvv::editor {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPresentTimeout = std::chrono::milliseconds(30);

}  // namespace

void RenderQueue::change(const std::function<void()>& set) {
    {
        const std::lock_guard lock(mutex_);
        set();
    }
    changed_.notify_all();
}

void RenderQueue::show(ShownDocument stage) {
    change([&] { stage_ = std::move(stage); });
}

void RenderQueue::request(ViewRequest view) {
    change([&] { view_ = std::move(view); });
}

void RenderQueue::replace_shaders(ShaderReplacement replacement) {
    change([&] { replacement_ = std::move(replacement); });
}

void RenderQueue::post(RenderTask task) {
    change([&] { tasks_.push_back(std::move(task)); });
}

void RenderQueue::post_idle(IdleTask idle) {
    change([&] { idle_.push_back(std::move(idle)); });
}

void RenderQueue::set_clips_read(bool read) {
    change([&] { clips_read_ = read; });
}

void RenderQueue::presented(uint64_t number) {
    change([&] { presented_ = number; });
}

void RenderQueue::stop() {
    change([&] { stop_ = true; });
}

void RenderQueue::restart() {
    change([&] { stop_ = false; });
}

std::optional<RenderJob> RenderQueue::next(const Ready& ready) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPresentTimeout, [&] { return stop_ || presented_ >= ready.displayed; });
    const auto has_job = [&] {
        const bool has_task = !tasks_.empty() && !ready.stage_waits;
        return stop_ || stage_ || clips_read_ || replacement_ ||
               (ready.has_stage && (has_task || view_ || !idle_.empty()));
    };
    if (ready.due && ready.has_stage)
        changed_.wait_until(lock, *ready.due, has_job);
    else
        changed_.wait(lock, has_job);
    if (stop_) return {};
    return take(ready);
}

RenderJob RenderQueue::take(const Ready& ready) {
    RenderJob job;
    if (stage_) {
        job.stage = std::exchange(stage_, std::nullopt);
    } else if (std::exchange(clips_read_, false)) {
        job.clips_read = true;
    } else if (replacement_) {
        job.replacement = std::exchange(replacement_, std::nullopt);
    } else if (!tasks_.empty() && !ready.stage_waits) {
        job.task = std::move(tasks_.front());
        tasks_.pop_front();
    } else if (view_) {
        job.view = std::exchange(view_, std::nullopt);
    } else if (ready.due && Clock::now() >= *ready.due) {
        job.due = true;
    } else if (!idle_.empty()) {
        job.idle = idle_.front();
    }
    return job;
}

std::optional<ViewRequest> RenderQueue::take_view() {
    const std::lock_guard lock(mutex_);
    return std::exchange(view_, std::nullopt);
}

std::optional<VkExtent2D> RenderQueue::waiting_size() const {
    const std::lock_guard lock(mutex_);
    if (!view_) return {};
    return VkExtent2D{view_->camera.width, view_->camera.height};
}

void RenderQueue::end_idle() {
    const std::lock_guard lock(mutex_);
    idle_.pop_front();
}

}  // namespace neuvv::editor
