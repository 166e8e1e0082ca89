// Runs one export at a time. While it runs, the document is frozen: it cannot be edited.
#pragma once

#include <memory>

#include "tools/viewer/context.h"
#include "tools/viewer/verbs/export.h"

namespace neuvv::viewer {

class Exporter {
  public:
    // Cancels the export, where one is under way. To be called before the render thread stops.
    void cancel();
    // Starts an export: the render thread draws its blocks whenever it has nothing else to draw. No other export may be
    // under way.
    void begin(Context& context, std::shared_ptr<Export> job);
    // To be called once a frame. When the export has ended, notifies the user of its result and unfreezes the document.
    void tick(Context& context);

    Export* job() const { return job_.get(); }   // null: no export is under way
    double begin_s() const { return begin_s_; }  // when it began, as FrameInput::now_s

  private:
    std::shared_ptr<Export> job_;
    double begin_s_ = 0;
};

}  // namespace neuvv::viewer
