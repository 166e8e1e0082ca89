#include "editor/draw/render_thread.h"

#include "base/error.h"
#include "base/trace_file.h"

namespace neuvv::editor {

RenderThread::RenderThread(const gpu::Device& device, std::function<void()> wake)
    : state_(std::move(wake)),
      stage_(device, state_, [this] { queue_.set_clips_read(); }),
      views_(device, stage_, state_) {
    begin();
}

void RenderThread::begin() {
    thread_ = std::thread([this] {
        try {
            run();
        } catch (...) {
            state_.set_failure(std::current_exception());
        }
        state_.wake();
    });
}

void RenderThread::stop() {
    queue_.stop();
    if (thread_.joinable()) thread_.join();
}

void RenderThread::release() {
    stop();
    views_.release();
    stage_.release();  // tasks wait until there is one again
    queue_.set_clips_read(false);
    state_.change([](RenderThreadState& state) {
        state.displayed.image.reset();
        state.displayed.finished = false;
        state.waits_since.reset();
    });
}

void RenderThread::restart() {
    queue_.restart();
    state_.set_failure(nullptr);
    begin();
}

// Where the device has no memory left or a file is missing, the last image stays; only a lost device ends the thread.
void RenderThread::run() {
    name_trace_thread("renders");
    const auto ready = [this] {
        return RenderQueue::Ready{stage_.is_there(), stage_.is_waiting(), state_.displayed_number(), views_.due()};
    };
    while (std::optional<RenderJob> job = queue_.next(ready())) {
        try {
            do_job(*job);
        } catch (const InputError& error) {
            views_.stop_refining();
            state_.report_problem(error.what(), 0);
        } catch (const RuntimeFailure& error) {
            views_.stop_refining();
            const auto* vulkan = dynamic_cast<const gpu::VulkanError*>(&error);
            if (vulkan && vulkan->device_lost()) throw;
            state_.report_problem(error.what(), 0);
        }
    }
}

void RenderThread::do_job(RenderJob& job) {
    if (job.stage) {
        if (stage_.show(*job.stage, size_to_come())) draw_newest();
    } else if (job.clips_read) {
        if (stage_.show_waiting(size_to_come())) draw_newest();
    } else if (job.replacement) {
        replace_shaders_now(*job.replacement);
    } else if (job.task) {
        OnDevice on_device = stage_.on_device();
        job.task(on_device);
    } else if (job.view) {
        views_.draw(std::move(*job.view));
    } else if (job.due) {
        views_.go_on();
    } else if (job.idle) {
        OnDevice on_device = stage_.on_device();
        if (!job.idle(on_device)) queue_.end_idle();
    }
}

void RenderThread::replace_shaders_now(const ShaderReplacement& replacement) {
    const std::string problem = stage_.replace_shaders(replacement.shaders, size_to_come(), [this] { draw_newest(); });
    if (!problem.empty()) views_.stop_refining();
    replacement.done(problem);
}

// Draws the newest view at once, so that a stage that changes all the time is drawn, too.
void RenderThread::draw_newest() {
    if (!stage_.is_there()) return;
    if (std::optional<ViewRequest> view = queue_.take_view())
        views_.draw(std::move(*view));
    else
        views_.draw_again();
}

// The size of the images to come, as far as that is known.
VkExtent2D RenderThread::size_to_come() const {
    constexpr VkExtent2D kBeforeTheFirstView{1280, 720};
    if (const std::optional<VkExtent2D> size = queue_.waiting_size()) return *size;
    return views_.size().value_or(kBeforeTheFirstView);
}

}  // namespace neuvv::editor
