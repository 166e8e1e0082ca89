#include "tools/viewer/image_requests.h"

#include <algorithm>
#include <utility>

#include "tools/viewer/view_request.h"

namespace neuvv::viewer {

void ImageRequests::send(Context& context, const render::PerformerHighlight& highlight) {
    const FrameMeter::Ids before = requested();
    send_document(context);
    send_view(context, highlight);
    std::optional<double> event_s = context.frame.event_s;
    if (const auto earlier_event_s = std::exchange(context.requests.earlier_event_s, std::nullopt))
        event_s = std::min(event_s.value_or(*earlier_event_s), *earlier_event_s);
    if (event_s && context.frame.rendered.displayed.view > 0 && requested() != before)
        meter.request(requested(), *event_s);
}

void ImageRequests::send_again(Context& context) {
    context.requests.reload_document = true;
    if (!view_) return;
    ++view_->id;
    context.render_thread.request(*view_);
}

bool ImageRequests::is_sharp(const FrameInput& frame) const {
    const editor::DisplayedImage& displayed = frame.rendered.displayed;
    return displayed.finished && view_ && displayed.view == view_->id && displayed.stage == document_;
}

void ImageRequests::send_document(Context& context) {
    const editor::Editor& editor = context.editor;
    if (std::exchange(context.requests.reload_document, false)) document_ = 0;
    if (!editor.is_open() || editor.id() == document_) return;
    document_ = editor.id();
    context.render_thread.show(std::make_shared<const edit::Document>(editor.document()), document_);
    if (editor.dragging()) context.mark_motion();
}

void ImageRequests::send_view(Context& context, const render::PerformerHighlight& highlight) {
    const FrameInput& frame = context.frame;
    if (!frame.stage || frame.camera.width < 2 || frame.camera.height < 2) return;
    const bool moving = context.view.clock.playing || context.in_motion() || context.editor.dragging();
    editor::ViewRequest view = requested_view(frame, context.view, moving);
    view.highlight = highlight;
    if (view_ && is_same_image(*view_, view)) return;
    view.id = view_ ? view_->id + 1 : 1;
    view_ = view;
    context.render_thread.request(std::move(view));
}

}  // namespace neuvv::viewer
