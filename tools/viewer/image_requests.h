// What the render thread was asked for, and how soon it came: the last view and document that were sent there.
#pragma once

#include "tools/viewer/context.h"
#include "tools/viewer/frame_meter.h"

namespace neuvv::viewer {

class ImageRequests {
  public:
    // Sends the document and the view where they have changed. They are the effect of this frame's first event, or of
    // the earlier event that FrameRequests names.
    void send(Context& context, const render::PerformerHighlight& highlight);
    // Sends them again, for a render thread that was restarted.
    void send_again(Context& context);

    // The image that is displayed is final.
    bool is_sharp(const FrameInput& frame) const;
    bool is_still() const { return view_ && !view_->moving; }

    FrameMeter meter;

  private:
    void send_document(Context& context);
    void send_view(Context& context, const render::PerformerHighlight& highlight);
    FrameMeter::Ids requested() const { return {view_ ? view_->id : 0, document_}; }

    std::optional<editor::ViewRequest> view_;
    uint64_t document_ = 0;  // its Editor::id()
};

}  // namespace neuvv::viewer
