// What panels and tools work with. They change the stage only through Editor::edit and Editor::drag, so that every
// change can be undone. What they need from the frame loop (viewer.cpp) they write into FrameRequests.
//
// The viewer has one context (editing_session.h), which lives as long as the viewer does. Jobs and tasks of the render
// thread may keep its address.
#pragma once

#include <algorithm>
#include <optional>

#include "base/threads/job_queue.h"
#include "editor/draw/render_thread.h"
#include "editor/editor.h"
#include "editor/parts.h"
#include "tools/viewer/frame_input.h"
#include "tools/viewer/report.h"
#include "tools/viewer/view_state.h"

namespace neuvv::viewer {

constexpr double kStillAfter_s = 0.12;

// What panels and tools request of the frame loop.
struct FrameRequests {
    int frames = 3;                 // how many more frames are drawn even if no event comes
    double last_motion_s = -1e9;    // when something in the image moved last; as FrameInput::now_s
    std::optional<Eye> eye;         // the eye flies there
    std::optional<float> ui_scale;  // of panels, from the next frame on
    bool reload_document = false;   // a clip's file has changed: the render thread reads the stage again
    // The event that caused this frame's changes, where it came before the events of this frame (a stroke of paint).
    std::optional<double> earlier_event_s;
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
    // Converts pixels at scale 1 to pixels of the framebuffer.
    float ui(float pixels) const { return pixels * frame.ui_scale; }
    // Draws the window at least so many times more, even if no event comes.
    void redraw(int frames = 3) const { requests.frames = std::max(requests.frames, frames); }
    // To be called while something in the image moves: images then come soon, with fewer rays where time is short.
    void mark_motion() const { requests.last_motion_s = frame.now_s; }
    // The eye flies, or something moved a moment ago.
    bool in_motion() const { return requests.eye || frame.now_s - requests.last_motion_s < kStillAfter_s; }
    // Lets the eye fly to `target`.
    void go_to(const Eye& target) const { requests.eye = target; }
    // The stage that is drawn, which may be some edits behind the document. Null where it has another number of nodes
    // than the document: then a node's number would mean another node.
    const stage::Stage* stage_of_document() const {
        const stage::Stage* stage = frame.stage.get();
        return stage && editor.is_open() && stage->scene.nodes.size() == editor.node_count() ? stage : nullptr;
    }
};

}  // namespace neuvv::viewer
