// The render thread: it has the stage on the device and draws the requested view, so that the editor's thread never
// waits for an image, a file or an export.
//
//     show(stage)   ┐                         ┌─► state()
//     request(view) ├─► the render thread ────┤
//     post(task)    ┘                         └─► wake()
//
// While views change it traces few rays, as many as fit its target of time. When nothing changes any more it draws the
// view again in blocks, each so small that the next change need not wait longer than an image takes meanwhile.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "edit/edited_stage.h"
#include "editor/block_grid.h"
#include "editor/dynamic_scale.h"
#include "render/stage_renderer.h"

namespace neuvv::editor {

// A view of the stage that is to be drawn.
struct ViewRequest {
    uint64_t id = 0;       // the caller's, ascending
    stage::Camera camera;  // of the image's size
    double time_s = 0;
    std::vector<double> next_s;       // the times that will be shown next, the first first: their slices are prefetched
    render::ResolveSettings resolve;  // its background counts only with `overrides_background`, else the stage's does
    bool overrides_background = false;
    bool moving = false;   // the image shall come soon rather than sharp
    double max_scale = 1;  // rays a pixel along each side while moving, at most
    uint32_t samples = 1;  // when still
};

// The image that is displayed now.
struct DisplayedImage {
    uint64_t number = 0;  // another one each time the image changes
    uint64_t view = 0;    // the id of its request; 0: none yet
    uint64_t stage = 0;   // that show() was given with it
    // Layout TRANSFER_SRC; written by the device's queue in order with what shows it. Null before the first image.
    std::shared_ptr<const gpu::DeviceImage> image;
    VkExtent2D size{};  // of the image's upper left
    double scale = 1;   // rays a pixel along each side
    bool finished = false;
    double milliseconds = 0;  // that drawing took, of all its blocks
    std::vector<gpu::PassTime> passes;
    uint64_t live_leaves = 0;
};

// The stage on the device, as tasks find it.
struct OnDevice {
    const gpu::Device& device;
    const stage::Stage& stage;
    render::StageRenderer& renderer;
};

struct RenderThreadState {
    std::shared_ptr<const stage::Stage> stage;  // that is drawn; null before the first
    uint64_t stage_id = 0;                      // that show() was given with it
    // By clip: the box around its leaves, low and high, in the performer's space.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> leaf_boxes;
    DisplayedImage displayed;
    std::string loading;  // the file that is being read; empty: none
    size_t files_read = 0, files = 0;
    std::string problem;      // why the last stage that was given is not drawn; empty: it is
    uint64_t unsound_id = 0;  // that show() was given with the last document that could never be drawn
};

constexpr double kMovingTarget_ms = 45;

class RenderThread {
  public:
    // `wake` is called from the render thread after anything changed.
    RenderThread(const gpu::Device& device, std::function<void()> wake);
    ~RenderThread();
    // Waits for what is being drawn; nothing is drawn after that.
    void stop();
    RenderThread(const RenderThread&) = delete;
    RenderThread& operator=(const RenderThread&) = delete;

    // Draws this stage, and this view, from now on; of several only the last counts.
    void show(std::shared_ptr<const edit::Document> stage, uint64_t id);
    void request(ViewRequest view);

    // Runs between two images, in order, before views; not before there is a stage. What it throws becomes
    // the state's problem.
    using Task = std::function<void(OnDevice&)>;
    void post(Task task);
    // Runs again and again while nothing else is to be done, until it is false. One at a time: a second waits.
    using Idle = std::function<bool(OnDevice&)>;
    void post_idle(Idle idle);

    // Passes of other shaders, in a renderer that reads its clips again; `done` is called on the render thread, with
    // the reason where they cannot be made, which leaves the last ones; else with an empty text.
    void replace_shaders(gpu::ShaderReplacements shaders, std::function<void(const std::string& problem)> done);

    // The commands that present this image are in the device's queue. The next image waits for that, though not long:
    // the queue would present this one only after it.
    void presented(uint64_t number);

    // Throws the exception that ended the thread.
    RenderThreadState state() const;

  private:
    // What is left of a view that stands still, from a time on.
    struct Refinement {
        uint32_t next = 0;     // block of the grid
        uint32_t samples = 1;  // of this round
        std::chrono::steady_clock::time_point start;
        DisplayedImage displayed;
    };
    struct Replacement {
        gpu::ShaderReplacements shaders;
        std::function<void(const std::string&)> done;
    };
    struct Job;
    void run();
    void do_job(Job& job);
    void replace_shaders_now(const Replacement& replacement);
    void report_progress(const std::string& file, size_t done, size_t of);
    void report_problem(std::string problem, uint64_t unsound_id);
    bool wait_for_job(Job& job);
    void load(std::shared_ptr<const edit::Document> document, uint64_t id);
    bool is_sound(const edit::Document& document) const;
    void make_renderer(const stage::Stage& stage, const render::StageLoader::Loaded& progress);
    void fit(VkExtent2D size);
    void draw_newest();
    void draw(const ViewRequest& view);
    void draw_block(const ViewRequest& view, uint32_t block, uint32_t side, uint32_t samples);
    void refine();
    render::FrameSettings settings_of(const ViewRequest& view, const stage::EvaluatedStage& evaluated) const;
    void copy_to_image(const gpu::Buffer& pixels, VkOffset2D at, VkExtent2D size);
    void publish(DisplayedImage displayed);

    const gpu::Device& device_;
    std::function<void()> wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false;
    std::exception_ptr failure_;
    std::shared_ptr<const edit::Document> next_stage_;
    uint64_t next_stage_id_ = 0;
    std::optional<ViewRequest> next_view_;
    std::optional<Replacement> next_replacement_;
    std::deque<Task> tasks_;
    std::deque<Idle> idle_;
    uint64_t presented_ = 0;
    RenderThreadState state_;

    // The thread's own.
    std::shared_ptr<const edit::Document> document_;
    std::shared_ptr<const stage::Stage> stage_;
    std::unique_ptr<render::StageLoader> loader_;  // made with the first renderer
    std::unique_ptr<render::StageRenderer> renderer_;
    VkExtent2D capacity_{};
    uint64_t stage_id_ = 0;
    std::shared_ptr<const gpu::DeviceImage> image_;  // is shown once it holds something
    gpu::Commands commands_;
    DynamicScale scale_;
    BlockGrid grid_;
    std::optional<ViewRequest> view_;  // that is drawn now
    std::optional<Refinement> refinement_;
    std::thread thread_;  // the last: it uses all of the above
};

}  // namespace neuvv::editor
