// What work on the open document needs that leaves its owner's thread and comes back.
#pragma once

#include "base/job_queue.h"
#include "editor/editor.h"
#include "editor/render_thread.h"

namespace neuvv::editor {

// References, to be copied into jobs and tasks. `jobs` also brings the results of render tasks back (JobQueue::post).
struct Parts {
    Editor& editor;
    JobQueue& jobs;
    RenderThread& render_thread;
};

}  // namespace neuvv::editor
