// The three parts of an open document that work needs when it leaves the editor's thread and comes back to it.
#pragma once

#include "base/threads/job_queue.h"
#include "editor/draw/render_thread.h"
#include "editor/editor.h"

namespace neuvv::editor {

// References, which jobs and tasks may copy. The results of render tasks, too, return to the editor's thread by `jobs`
// (JobQueue::post).
struct Parts {
    Editor& editor;
    JobQueue& jobs;
    RenderThread& render_thread;
};

}  // namespace neuvv::editor
