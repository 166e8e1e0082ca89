#include "tools/viewer/exporter.h"

namespace neuvv::viewer {

void Exporter::cancel() {
    if (job_) job_->cancel();
}

void Exporter::begin(Context& context, std::shared_ptr<Export> job) {
    job_ = std::move(job);
    begin_s_ = context.frame.now_s;
    context.view.clock.pause();
    context.editor.freeze("an export goes on: cancel it to edit");
    context.render_thread.post_idle([job = job_](editor::OnDevice& on_device) {
        const bool more = job->step(on_device);
        ui::Window::wake();
        return more;
    });
}

void Exporter::tick(Context& context) {
    const std::optional<Export::End> end = job_ ? job_->end() : std::nullopt;
    if (!end) return;
    context.editor.freeze({});
    context.editor.notify(end->text, end->error);
    job_.reset();
}

}  // namespace neuvv::viewer
