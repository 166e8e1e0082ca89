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

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "edit/edited_stage.h"
#include "editor/draw/block_grid.h"
#include "editor/draw/dynamic_scale.h"
#include "render/clips/clip_preload.h"
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

// The image to be displayed now.
struct DisplayedImage {
    uint64_t number = 0;  // increases each time the image changes
    uint64_t view = 0;    // the id of its request; 0: none yet
    uint64_t stage = 0;   // the id that show() got with its stage
    // In layout TRANSFER_SRC. It is written on the device's queue, so that commands submitted there later read the
    // finished image. Null before the first image.
    std::shared_ptr<const gpu::DeviceImage> image;
    VkExtent2D size{};  // pixels at the image's upper left that are displayed
    double scale = 1;   // rays per pixel along each side
    bool finished = false;
    double milliseconds = 0;  // that drawing took, for all blocks together
    std::vector<gpu::PassTime> passes;
    uint64_t live_leaves = 0;
};

// The stage on the device, as passed to tasks.
struct OnDevice {
    const gpu::Device& device;
    const stage::Stage& stage;
    render::StageRenderer& renderer;
};

struct RenderThreadState {
    std::shared_ptr<const stage::Stage> stage;  // the stage that is drawn; null before the first
    uint64_t stage_id = 0;                      // the id that show() got with it
    // Per clip: the corners, low and high, of the box around its leaves, in the performer's space in metres.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> leaf_boxes;
    DisplayedImage displayed;
    std::string loading;  // the file whose clips are being read, or "shaders"; empty: nothing
    size_t files_read = 0, files = 0;
    // Since when the image shows something else than performers have at its time, because that is still being read, and
    // has not changed meanwhile; nothing: it shows what it should.
    std::optional<std::chrono::steady_clock::time_point> waits_since;
    std::string problem;      // why the newest stage, image or task failed; empty: no problem
    uint64_t unsound_id = 0;  // the id that show() got with the last document that is not sound
};

constexpr double kMovingTarget_ms = 45;

class RenderThread {
  public:
    // `wake` is called after anything in state() changed, on the render thread or on one that reads clips.
    RenderThread(const gpu::Device& device, std::function<void()> wake);
    ~RenderThread();
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
    void show(std::shared_ptr<const edit::Document> stage, uint64_t id);
    void request(ViewRequest view);

    // Posts a task. Tasks run between two images, in order, before views, once there is a stage. What a task throws
    // becomes state().problem.
    using Task = std::function<void(OnDevice&)>;
    void post(Task task);
    // Posts a task that is called again and again, while there is nothing else to do, until it returns false. Only one
    // runs at a time; a second one waits.
    using Idle = std::function<bool(OnDevice&)>;
    void post_idle(Idle idle);

    // Makes the passes anew from other shaders, in a renderer that reads its clips again. `done` is called on the
    // render thread: with an empty text, or with the reason where the passes cannot be made; then the last ones stay.
    void replace_shaders(gpu::ShaderReplacements shaders, std::function<void(const std::string& problem)> done);

    // To be called once the commands that present this image are in the device's queue. The next image waits for this
    // call, but not long: otherwise its commands could come first, and the image would be presented only after them.
    void presented(uint64_t number);

    // The newest state. Throws the exception that ended the thread, where one did.
    RenderThreadState state() const;

  private:
    // The refinement of a view that does not change: which block is drawn next.
    struct Refinement {
        uint32_t next = 0;     // the next block of the grid
        uint32_t samples = 1;  // of this round; see ViewRequest
        std::chrono::steady_clock::time_point start;
        DisplayedImage displayed;
    };
    struct Replacement {
        gpu::ShaderReplacements shaders;
        std::function<void(const std::string&)> done;
    };
    struct Job;
    struct Waiting {
        std::shared_ptr<const edit::Document> document;
        uint64_t id = 0;
    };
    void begin();
    void run();
    void do_job(Job& job);
    void replace_shaders_now(const Replacement& replacement);
    void report_progress(const std::string& file, size_t done, size_t of);
    void report_preload(const std::vector<std::filesystem::path>& clips, size_t read);
    void report_problem(std::string problem, uint64_t unsound_id);
    bool wait_for_job(Job& job);
    bool preloads(const Waiting& stage);
    void end_preload();
    void load(const std::shared_ptr<const edit::Document>& document, uint64_t id);
    bool is_sound(const edit::Document& document) const;
    void report_unreadable_segments();
    void make_renderer(const stage::Stage& stage, const render::StageLoader::Loaded& progress);
    // The capacity for this many pixels, with room for blocks that are a few rays larger than their share of the image,
    // and for windows that grow a little.
    static uint32_t roomy(uint32_t pixels);
    void fit(VkExtent2D size);
    void draw_newest();
    void draw(const ViewRequest& view);
    void note_waiting(bool waits, const stage::EvaluatedStage& evaluated);
    void look_for_missing();
    void draw_block(const ViewRequest& view, uint32_t block, uint32_t side, uint32_t samples);
    void refine();
    render::FrameSettings settings_of(const ViewRequest& view, const stage::EvaluatedStage& evaluated) const;
    void draw_to_image(const stage::Camera& camera, const render::FrameSettings& settings, VkOffset2D at);
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
    bool preloaded_ = false;  // what preload_ reads is there, or cannot be read
    RenderThreadState state_;

    // Used by the render thread alone.
    std::shared_ptr<const edit::Document> document_;
    std::shared_ptr<const stage::Stage> stage_;
    std::unique_ptr<render::StageLoader> loader_;  // null before the first renderer
    std::unique_ptr<render::StageRenderer> renderer_;
    std::unique_ptr<render::ClipPreload> preload_;  // null: no clip is being read
    std::optional<Waiting> waiting_;                // the stage whose clips are being read
    VkExtent2D capacity_{};
    uint64_t stage_id_ = 0;
    std::shared_ptr<const gpu::DeviceImage> image_;  // to be displayed once something was drawn into it
    DynamicScale scale_;
    BlockGrid grid_;
    std::optional<ViewRequest> view_;  // the view that is drawn now
    std::optional<Refinement> refinement_;
    // When to look whether what a view that does not change lacks has been read; nothing: it lacks nothing.
    std::optional<std::chrono::steady_clock::time_point> look_at_;
    std::vector<std::pair<const render::Field*, float>> shown_;  // what was drawn last, to be compared alone
    std::thread thread_;  // the last member, because the thread uses all of the above
};

}  // namespace neuvv::editor
