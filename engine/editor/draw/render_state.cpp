#include "editor/draw/render_state.h"

namespace neuvv::editor {

RenderThreadState RenderState::now() const {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    return state_;
}

uint64_t RenderState::displayed_number() const {
    const std::lock_guard lock(mutex_);
    return state_.displayed.number;
}

void RenderState::change(const std::function<void(RenderThreadState&)>& set) {
    const std::lock_guard lock(mutex_);
    set(state_);
}

void RenderState::report(const std::function<void(RenderThreadState&)>& set) {
    change(set);
    wake_();
}

void RenderState::publish(DisplayedImage displayed) {
    report([&](RenderThreadState& state) {
        displayed.number = state.displayed.number + 1;
        state.displayed = std::move(displayed);
    });
}

void RenderState::report_progress(const std::string& file, size_t done, size_t of) {
    report([&](RenderThreadState& state) {
        state.loading = file;
        state.files_read = done;
        state.files = of;
    });
}

void RenderState::report_problem(const std::string& problem, uint64_t unsound_id) {
    report([&](RenderThreadState& state) {
        state.loading.clear();
        state.problem = problem;
        if (unsound_id) state.unsound_id = unsound_id;
    });
}

void RenderState::set_failure(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(failure);
}

}  // namespace neuvv::editor
