// The render thread: it has the stage on the device and draws the requested view, so that the editor's thread never
// waits for an image, a file or an export.
//
//     show(stage)   ┐                         ┌─► state()
//     request(view) ├─► the render thread ────┤
//     post(task)    ┘                         └─► wake()
//
// While the view changes, an image has only as many rays as can be traced in the target time. Once nothing changes any
// more, the thread draws the view again with all its rays, in blocks: a change then waits for one block, which takes
// about as long as an image of a moving view.
#pragma once

#include <thread>

#include "editor/draw/view_drawer.h"

namespace neuvv::editor {

class RenderThread {
  public:
    // `wake` is called after anything in state() changed, on the render thread or on one that reads clips.
    RenderThread(const gpu::Device& device, std::function<void()> wake);
    ~RenderThread() { stop(); }
    // Waits until the current image is drawn, then ends the thread.
    void stop();
    // For a device that was lost: ends the thread and frees all that it has on the device, the displayed image
    // included, so that the device can be destroyed. Tasks and requests that wait stay.
    void release();
    // Begins the thread again, on a device that was made anew in the place of the one of the constructor. The stage and
    // the view must be sent again.
    void restart();
    RenderThread(const RenderThread&) = delete;
    RenderThread& operator=(const RenderThread&) = delete;

    // Draw this stage, and this view, from now on. Where several wait, only the newest is drawn. The clips of a stage
    // that the one before does not have are read by another thread first: until then, views show the stage before, and
    // tasks wait.
    void show(std::shared_ptr<const edit::Document> stage, uint64_t id) { queue_.show({std::move(stage), id}); }
    void request(ViewRequest view) { queue_.request(std::move(view)); }

    // Posts a task. Tasks run between two images, in order, before views, once there is a stage. What a task throws
    // becomes state().problem.
    void post(RenderTask task) { queue_.post(std::move(task)); }
    // Posts a task that is called again and again, while there is nothing else to do, until it returns false. Only one
    // runs at a time; a second one waits.
    void post_idle(IdleTask idle) { queue_.post_idle(std::move(idle)); }

    // Makes the passes anew from other shaders, in a renderer that reads its clips again. `done` is called on the
    // render thread: with an empty text, or with the reason where the passes cannot be made; then the last ones stay.
    void replace_shaders(gpu::ShaderReplacements shaders, std::function<void(const std::string& problem)> done) {
        queue_.replace_shaders({std::move(shaders), std::move(done)});
    }

    // To be called once the commands that present this image are in the device's queue. The next image waits for this
    // call, but not long: otherwise its commands could come first, and the image would be presented only after them.
    void presented(uint64_t number) { queue_.presented(number); }

    // The newest state. Throws the exception that ended the thread, where one did.
    RenderThreadState state() const { return state_.now(); }

  private:
    void begin();
    void run();
    void do_job(RenderJob& job);
    void replace_shaders_now(const ShaderReplacement& replacement);
    void draw_newest();
    VkExtent2D size_to_come() const;

    RenderState state_;
    RenderQueue queue_;
    // Used by the render thread alone.
    StageOnDevice stage_;
    ViewDrawer views_;
    std::thread thread_;  // the last member, because the thread uses all of the above
};

}  // namespace neuvv::editor
