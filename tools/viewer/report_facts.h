// Adds all facts to the report: everything that it says besides the areas of buttons and handles.
#pragma once

#include "tools/viewer/coaching.h"
#include "tools/viewer/context.h"
#include "tools/viewer/frame_meter.h"
#include "tools/viewer/tools/paint_tool.h"
#include "tools/viewer/verbs/verb_task.h"

namespace neuvv::viewer {

struct ReportedState {
    const PaintTool& paint;
    const Coaching& coaching;
    const FrameMeter& meter;
    const ui::Window& window;
    std::span<const editor::Notice> notices;
    std::span<const std::string> validation_messages;
    const VerbTask& verb;
    const std::string& title;     // of the window
    bool image_is_sharp = false;  // the displayed image is final, and nothing moves
};
// Does nothing where no report is written.
void report_facts(const Context& context, const ReportedState& state);

}  // namespace neuvv::viewer
