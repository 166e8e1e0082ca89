// The export that is under way: one at a time. Meanwhile nothing is edited.
#pragma once

#include <memory>

#include "tools/viewer/context.h"
#include "tools/viewer/export.h"

namespace neuvv::viewer {

class Exporter {
  public:
    // Stops one that is under way; call it before the render thread stops.
    void cancel();
    // Begins to draw the job's blocks whenever the render thread has nothing else to draw. None may be under way.
    void begin(Context& context, std::shared_ptr<Export> job);
    // Each frame: says how it ended, and lets the stage be edited again.
    void tick(Context& context);

    Export* job() const { return job_.get(); }   // null: none is under way
    double begin_s() const { return begin_s_; }  // when it began, of FrameInput::now_s

  private:
    std::shared_ptr<Export> job_;
    double begin_s_ = 0;
};

}  // namespace neuvv::viewer
