// What panels and tools work with. Everything that they change of the stage goes through Editor::edit or Editor::drag,
// so that it can be undone; what they want of the frame loop goes into FrameRequests.
//
// One context lives as long as the viewer. Jobs and tasks of the render thread may keep its address.
#pragma once

#include <algorithm>
#include <optional>

#include "base/job_queue.h"
#include "editor/editor.h"
#include "editor/parts.h"
#include "editor/render_thread.h"
#include "tools/viewer/frame_input.h"
#include "tools/viewer/report.h"
#include "tools/viewer/view_state.h"

namespace neuvv::viewer {

// What panels and tools ask of the frame loop.
struct FrameRequests {
    int frames = 3;                    // that the window is drawn again, though no event comes
    double last_motion_s = -1e9;       // when something in the image moved
    std::optional<Eye> eye;            // where the eye shall go, smoothly
    std::optional<float> ui_scale;     // of panels, from the next frame on
    bool document_again = false;       // files that the stage plays have changed: read it anew
    std::optional<double> answered_s;  // when the event came that this frame's changes answer, where that was earlier
};

struct Context {
    editor::Editor& editor;
    JobQueue& jobs;
    editor::RenderThread& render_thread;
    Report& report;
    const FrameInput& frame;
    ViewState& view;
    FrameRequests& requests;

    editor::Parts parts() const { return {editor, jobs, render_thread}; }
    // From pixels at scale 1 to pixels of the framebuffer.
    float ui(float pixels) const { return pixels * frame.ui_scale; }
    void redraw(int frames = 3) const { requests.frames = std::max(requests.frames, frames); }
    // Something in the image moves just now: it is drawn soon rather than sharp.
    void moves() const { requests.last_motion_s = frame.now_s; }
    void go_to(const Eye& target) const { requests.eye = target; }
    // The stage that is drawn, where its nodes have the document's numbers: it may be some edits behind. Else null.
    const stage::Stage* stage_of_document() const {
        const stage::Stage* stage = frame.stage.get();
        return stage && editor.is_open() && stage->scene.nodes.size() == editor.node_count() ? stage : nullptr;
    }
};

}  // namespace neuvv::viewer
