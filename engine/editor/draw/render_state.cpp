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

void RenderState::change(const std::function<void(RenderThreadState&)>& change) {
    const std::lock_guard lock(mutex_);
    change(state_);
}

void RenderState::tell(const std::function<void(RenderThreadState&)>& what) {
    change(what);
    wake_();
}

void RenderState::publish(DisplayedImage displayed) {
    tell([&](RenderThreadState& state) {
        displayed.number = state.displayed.number + 1;
        state.displayed = std::move(displayed);
    });
}

void RenderState::tell_progress(const std::string& file, size_t done, size_t of) {
    tell([&](RenderThreadState& state) {
        state.loading = file;
        state.files_read = done;
        state.files = of;
    });
}

void RenderState::tell_problem(const std::string& problem, uint64_t unsound_id) {
    tell([&](RenderThreadState& state) {
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
