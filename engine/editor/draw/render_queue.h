// What the render thread is to do next: the newest stage and view, new shaders, tasks and idle work.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "edit/edited_stage.h"
#include "render/clips/stage_renderer.h"

namespace neuvv::editor {

// A view of the stage to be drawn.
struct ViewRequest {
    uint64_t id = 0;       // ascending; DisplayedImage::view returns it
    stage::Camera camera;  // of the image's size
    double time_s = 0;
    std::vector<double> next_s;  // the times that will be displayed next, in order; their slices are prefetched
    render::PerformerHighlight highlight;
    render::ResolveSettings resolve;    // its background counts only with `overrides_background`
    bool overrides_background = false;  // false: the background is that of the stage
    bool moving = false;                // the view changes: images should come soon, if with fewer rays
    double max_scale = 1;               // the most rays per pixel along each side while `moving`
    uint32_t samples = 1;               // rays per pixel along each side while not `moving`
    bool far_levels = true;             // FrameSettings::far_levels
};

// The stage on the device, as passed to tasks.
struct OnDevice {
    const gpu::Device& device;
    const stage::Stage& stage;
    render::StageRenderer& renderer;
};
using RenderTask = std::function<void(OnDevice&)>;
using IdleTask = std::function<bool(OnDevice&)>;  // is called again until it returns false

// A document, and the id that show() got with it.
struct ShownDocument {
    std::shared_ptr<const edit::Document> document;
    uint64_t id = 0;
};

struct ShaderReplacement {
    gpu::ShaderReplacements shaders;
    std::function<void(const std::string& problem)> done;
};

// One of these.
struct RenderJob {
    std::optional<ShownDocument> stage;
    bool clips_read = false;
    std::optional<ShaderReplacement> replacement;
    RenderTask task;
    std::optional<ViewRequest> view;
    bool due = false;  // Ready::due has come
    IdleTask idle;
};

// The jobs that wait. Every function may be called on any thread.
class RenderQueue {
  public:
    // Of several stages, views or replacements that wait, only the newest counts.
    void show(ShownDocument stage);
    void request(ViewRequest view);
    void replace_shaders(ShaderReplacement replacement);
    void post(RenderTask task);
    void post_idle(IdleTask idle);
    // That the clips for which a stage waits have been read.
    void set_clips_read(bool read = true);
    // That the image of this number has been presented.
    void presented(uint64_t number);
    // next() returns nothing until restart().
    void stop();
    void restart();

    // What the render thread has, on which depends what it can do.
    struct Ready {
        bool has_stage = false;    // without one, only stages and shaders count
        bool stage_waits = false;  // for its clips: tasks are for that stage, and wait, too
        uint64_t displayed = 0;    // the image that should be presented first; that is not waited for for long
        std::optional<std::chrono::steady_clock::time_point> due;  // when the drawn view needs another look
    };
    // Waits for the next job, in this order: the newest stage, the one whose clips have been read, new shaders, tasks,
    // the newest view, the drawn view that is due, idle work. nullopt where the thread must end.
    std::optional<RenderJob> next(const Ready& ready);
    // The newest view, where one waits.
    std::optional<ViewRequest> take_view();
    // The size of the newest view that waits.
    std::optional<VkExtent2D> waiting_size() const;
    // Removes the idle task that next() returned last.
    void end_idle();

  private:
    RenderJob take(const Ready& ready);
    // Calls `set` under the lock, and wakes next().
    void change(const std::function<void()>& set);

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false, clips_read_ = false;
    std::optional<ShownDocument> stage_;
    std::optional<ViewRequest> view_;
    std::optional<ShaderReplacement> replacement_;
    std::deque<RenderTask> tasks_;
    std::deque<IdleTask> idle_;
    uint64_t presented_ = 0;
};

}  // namespace neuvv::editor
