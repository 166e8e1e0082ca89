// The editing session: the open document with its history and selection, the threads that work for it, how the user
// looks at it, and what the frame loop is asked for. It owns all that a Context refers to.
#pragma once

#include "tools/viewer/context.h"

namespace neuvv::viewer {

struct EditingSession {
    // The device must outlive this object. `report_file` as Report has it.
    EditingSession(const gpu::Device& device, const std::filesystem::path& report_file);

    // Takes over the state of the render thread.
    void read_render_thread();
    // Takes over the stage that the render thread has read. An edit that made the document unsound is taken back.
    void receive_stage();
    // Evaluates the stage at the time that is displayed.
    void evaluate();

    Report report;
    JobQueue jobs;
    editor::RenderThread render_thread;
    editor::Editor editor;
    FrameInput input;
    ViewState view;
    FrameRequests requests;
    Context context{editor, jobs, render_thread, report, input, view, requests};
};

}  // namespace neuvv::viewer
