// The drawer: a thread that has the stage on the device and draws what is looked at, so that the window never waits
// for a picture, a file or an export.
//
//     show(stage) ┐                          ┌─► state()
//     look(view)  ├─► the drawer's thread ───┤
//     post(task)  ┘                          └─► wake()
//
// While views move it draws few rays, as many as its target of time allows; when nothing moves any more it draws the
// view again in blocks, each so small that the next move need not wait longer than a moving picture takes.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "edit/edited_stage.h"
#include "render/stage_renderer.h"
#include "tools/viewer/block_grid.h"
#include "tools/viewer/dynamic_scale.h"

namespace neuvv::viewer {

// What shall be seen.
struct Sight {
    uint64_t id = 0;       // of the caller, ascending
    stage::Camera camera;  // of the picture's size
    double time_s = 0;
    std::vector<double> next_s;       // will be seen next, the first first
    render::ResolveSettings resolve;  // its background only where `own_background`, else the stage's
    bool own_background = false;
    bool moving = false;    // rather soon than sharp
    double most_scale = 1;  // rays a pixel along each side while moving, at most
    uint32_t samples = 1;   // when still
};

// The picture as it is now.
struct Shown {
    uint64_t number = 0;  // another one each time that it changes
    uint64_t view = 0;    // id; 0: none yet
    uint64_t stage = 0;   // that show() was given with it
    // Layout TRANSFER_SRC; written by the device's queue in order with what shows it. Null before the first picture.
    std::shared_ptr<const gpu::DeviceImage> image;
    VkExtent2D size{};  // of the image's upper left
    double scale = 1;   // rays a pixel along each side
    bool finished = false;
    double milliseconds = 0;  // that drawing took, of all its blocks
    std::vector<gpu::PassTime> passes;
    uint64_t live_leaves = 0;
};

// The stage on the device, for tasks.
struct OnDevice {
    const gpu::Device& device;
    const stage::Stage& stage;
    render::StageRenderer& renderer;
};

struct DrawerState {
    std::shared_ptr<const stage::Stage> stage;  // that is drawn; null before the first
    uint64_t stage_id = 0;                      // that show() was given with it
    // By clip: around its leaves, low and high, performer's space.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> leaf_boxes;
    Shown shown;
    std::string loading;  // what is being read, empty: nothing
    size_t files_read = 0, files = 0;
    std::string problem;      // why the last stage that was given is not drawn; empty: it is
    uint64_t unsound_id = 0;  // that show() was given with the last document that could never be drawn
};

constexpr double kMovingTarget_ms = 45;

class Drawer {
  public:
    // `wake` is called from the drawer's thread after anything changed.
    Drawer(const gpu::Device& device, std::function<void()> wake);
    ~Drawer();
    // Waits for what is being drawn; nothing more is done then.
    void stop();
    Drawer(const Drawer&) = delete;
    Drawer& operator=(const Drawer&) = delete;

    // From now on, this; only the last of several counts.
    void show(std::shared_ptr<const edit::Document> stage, uint64_t id);
    void look(Sight view);

    // Runs between two pictures, in order, before views; not before there is a stage. What it throws is told as what is
    // wrong with the picture.
    using Task = std::function<void(OnDevice&)>;
    void post(Task task);
    // Runs again and again while nothing else is to be done, until it is false. One at a time: a second waits.
    using Idle = std::function<bool(OnDevice&)>;
    void post_idle(Idle idle);

    // Passes of other shaders, in a renderer that reads its clips again; `done` is told, on the drawer's thread, why
    // they cannot be made, which leaves the last ones, or nothing.
    void remake(gpu::ShaderReplacements shaders, std::function<void(const std::string& problem)> done);

    // What shows it was given to the device. The next picture waits for that, though not long: the queue would show
    // this one only after it.
    void taken(uint64_t number);

    // Throws what ended the thread.
    DrawerState state() const;

  private:
    // What is left of a view that stands still, from a time on.
    struct Refinement {
        uint32_t next = 0;     // block of the grid
        uint32_t samples = 1;  // of this round
        std::chrono::steady_clock::time_point from;
        Shown shown;
    };
    struct Remake {
        gpu::ShaderReplacements shaders;
        std::function<void(const std::string&)> done;
    };
    struct Job;
    void run();
    void do_job(Job& job);
    void make_again(const Remake& remake);
    void tell_progress(const std::string& file, size_t done, size_t of);
    void tell_problem(std::string problem, uint64_t unsound_id);
    bool wait_for_job(Job& job);
    void load(std::shared_ptr<const edit::Document> document, uint64_t id);
    static bool is_sound(const edit::Document& document);
    void make_renderer(const stage::Stage& stage, const render::StageLoader::Loaded& progress);
    void fit(VkExtent2D size);
    void draw_newest();
    void draw(const Sight& view);
    void draw_block(const Sight& view, uint32_t block, uint32_t side, uint32_t samples);
    void refine();
    render::FrameSettings settings_of(const Sight& view, const stage::StageInstant& instant) const;
    void copy_to_picture(const gpu::Buffer& pixels, VkOffset2D at, VkExtent2D size);
    void publish(Shown shown);

    const gpu::Device& device_;
    std::function<void()> wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false;
    std::exception_ptr failure_;
    std::shared_ptr<const edit::Document> next_stage_;
    uint64_t next_stage_id_ = 0;
    std::optional<Sight> next_view_;
    std::optional<Remake> next_remake_;
    std::deque<Task> tasks_;
    std::deque<Idle> idle_;
    uint64_t taken_ = 0;
    DrawerState state_;

    // The thread's own.
    std::shared_ptr<const edit::Document> document_;
    std::shared_ptr<const stage::Stage> stage_;
    std::unique_ptr<render::StageLoader> loader_;  // made with the first renderer
    std::unique_ptr<render::StageRenderer> renderer_;
    VkExtent2D capacity_{};
    uint64_t stage_id_ = 0;
    std::shared_ptr<const gpu::DeviceImage> picture_;  // is shown once it holds something
    gpu::Commands commands_;
    DynamicScale scale_;
    BlockGrid grid_;
    std::optional<Sight> view_;  // that is drawn now
    std::optional<Refinement> refinement_;
    std::thread thread_;  // the last: it uses all of the above
};

}  // namespace neuvv::viewer
