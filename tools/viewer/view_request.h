// What the render thread is asked to draw for the window's state.
#pragma once

#include "editor/draw/render_thread.h"
#include "tools/viewer/frame_input.h"
#include "tools/viewer/view_state.h"

namespace neuvv::viewer {

// The view of a frame, without an id or a highlight. There must be a stage. `moving` as ViewRequest has it.
editor::ViewRequest requested_view(const FrameInput& input, const ViewState& state, bool moving);

// Whether two requests, whatever their ids, have the same image.
bool is_same_image(const editor::ViewRequest& a, const editor::ViewRequest& b);

}  // namespace neuvv::viewer
