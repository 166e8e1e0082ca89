#include "editor/draw/render_thread.h"

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "base/trace_file.h"
#include "edit/read.h"

namespace neuvv::editor {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPresentTimeout = std::chrono::milliseconds(30);
constexpr VkExtent2D kInitialCapacity{1280, 720};

}  // namespace

struct RenderThread::Job {
    std::shared_ptr<const edit::Document> stage;
    uint64_t stage_id = 0;
    std::optional<Replacement> replacement;
    Task task;
    std::optional<ViewRequest> view;
    bool refine = false, look = false, preloaded = false;
    Idle idle;
};

RenderThread::RenderThread(const gpu::Device& device, std::function<void()> wake)
    : device_(device), wake_(std::move(wake)), scale_(kMovingTarget_ms), grid_(kMovingTarget_ms) {
    begin();
}

void RenderThread::begin() {
    thread_ = std::thread([this] {
        try {
            run();
        } catch (...) {
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
        }
        wake_();
    });
}

RenderThread::~RenderThread() {
    stop();
}

void RenderThread::stop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void RenderThread::release() {
    stop();
    refinement_.reset();
    look_at_.reset();
    view_.reset();
    waiting_.reset();
    preload_.reset();
    preloaded_ = false;
    renderer_.reset();
    loader_.reset();
    image_.reset();
    stage_.reset();  // tasks wait until there is one again
    const std::lock_guard lock(mutex_);
    state_.displayed.image.reset();
    state_.displayed.finished = false;
    state_.waits_since.reset();
}

void RenderThread::restart() {
    stop_ = false;
    failure_ = nullptr;
    begin();
}

void RenderThread::show(std::shared_ptr<const edit::Document> stage, uint64_t id) {
    {
        const std::lock_guard lock(mutex_);
        next_stage_ = std::move(stage);
        next_stage_id_ = id;
    }
    changed_.notify_all();
}

void RenderThread::request(ViewRequest view) {
    {
        const std::lock_guard lock(mutex_);
        next_view_ = std::move(view);
    }
    changed_.notify_all();
}

void RenderThread::post(Task task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
}

void RenderThread::post_idle(Idle idle) {
    {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(idle));
    }
    changed_.notify_all();
}

void RenderThread::replace_shaders(gpu::ShaderReplacements shaders, std::function<void(const std::string&)> done) {
    {
        const std::lock_guard lock(mutex_);
        next_replacement_ = Replacement{std::move(shaders), std::move(done)};
    }
    changed_.notify_all();
}

void RenderThread::presented(uint64_t number) {
    {
        const std::lock_guard lock(mutex_);
        presented_ = number;
    }
    changed_.notify_all();
}

RenderThreadState RenderThread::state() const {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    return state_;
}

// Waits for the next job and returns it, in this order: the newest stage, the one whose clips have been read, new
// shaders, tasks, the newest view, the next block of a view that does not change, idle work. Tasks are for the stage
// that was sent last, and wait for it. Returns false where the thread must end.
bool RenderThread::wait_for_job(Job& job) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPresentTimeout, [&] { return stop_ || presented_ >= state_.displayed.number; });
    const auto ready = [&] {
        return stop_ || next_stage_ || preloaded_ || next_replacement_ ||
               (stage_ && ((!tasks_.empty() && !waiting_) || next_view_ || !idle_.empty()));
    };
    if ((refinement_ || look_at_) && stage_)
        changed_.wait_until(lock, refinement_ ? refinement_->start : *look_at_, ready);
    else
        changed_.wait(lock, ready);
    if (stop_) return false;
    if (next_stage_) {
        job.stage = std::exchange(next_stage_, nullptr);
        job.stage_id = next_stage_id_;
    } else if (std::exchange(preloaded_, false)) {
        job.preloaded = true;
    } else if (next_replacement_) {
        job.replacement = std::exchange(next_replacement_, std::nullopt);
    } else if (!tasks_.empty() && !waiting_) {
        job.task = std::move(tasks_.front());
        tasks_.pop_front();
    } else if (next_view_) {
        job.view = std::exchange(next_view_, std::nullopt);
    } else if (refinement_ && Clock::now() >= refinement_->start) {
        job.refine = true;
    } else if (look_at_ && Clock::now() >= *look_at_) {
        job.look = true;
    } else if (!idle_.empty()) {
        job.idle = idle_.front();
    }
    return true;
}

// Where the device has no memory left or a file is missing, the last image stays; only a lost device ends the thread.
void RenderThread::run() {
    name_trace_thread("renders");
    for (Job job; wait_for_job(job); job = {}) {
        try {
            do_job(job);
        } catch (const InputError& error) {
            refinement_.reset();
            report_problem(error.what(), 0);
        } catch (const RuntimeFailure& error) {
            refinement_.reset();
            const auto* vulkan = dynamic_cast<const gpu::VulkanError*>(&error);
            if (vulkan && vulkan->device_lost()) throw;
            report_problem(error.what(), 0);
        }
    }
}

void RenderThread::do_job(Job& job) {
    if (job.stage) {
        waiting_.reset();
        if (preloads({job.stage, job.stage_id})) return;
        load(job.stage, job.stage_id);
        draw_newest();
    } else if (job.preloaded) {
        end_preload();
    } else if (job.replacement) {
        replace_shaders_now(*job.replacement);
    } else if (job.task) {
        OnDevice on_device{device_, *stage_, *renderer_};
        job.task(on_device);
    } else if (job.view) {
        view_ = std::move(job.view);
        draw(*view_);
    } else if (job.refine) {
        refine();
    } else if (job.look) {
        look_for_missing();
    } else if (job.idle) {
        OnDevice on_device{device_, *stage_, *renderer_};
        if (job.idle(on_device)) return;
        const std::lock_guard lock(mutex_);
        idle_.pop_front();
    }
}

void RenderThread::report_problem(std::string problem, uint64_t unsound_id) {
    {
        const std::lock_guard lock(mutex_);
        state_.loading.clear();
        state_.problem = std::move(problem);
        if (unsound_id) state_.unsound_id = unsound_id;
    }
    wake_();
}

// Whether the document could be drawn if all its clips were there.
bool RenderThread::is_sound(const edit::Document& document) const {
    try {
        stage::expect_sound_document(document.file, stage_.get());
    } catch (const InputError&) {
        return false;
    }
    return true;
}

void RenderThread::report_progress(const std::string& file, size_t done, size_t of) {
    {
        const std::lock_guard lock(mutex_);
        state_.loading = file;
        state_.files_read = done;
        state_.files = of;
    }
    wake_();
}

void RenderThread::replace_shaders_now(const Replacement& replacement) {
    const gpu::ShaderReplacements before = device_.shaders().replacements();
    device_.shaders().set(replacement.shaders);
    const VkExtent2D capacity = capacity_;
    std::unique_ptr<render::StageRenderer> last = std::move(renderer_);
    std::string problem;
    try {
        if (stage_) make_renderer(*stage_, [this](size_t done, size_t of) { report_progress("shaders", done, of); });
        draw_newest();  // some passes are made only when they are first needed
    } catch (const std::runtime_error& error) {
        device_.shaders().set(before);
        renderer_ = std::move(last);
        capacity_ = capacity;
        refinement_.reset();
        problem = error.what();
    }
    {
        const std::lock_guard lock(mutex_);
        state_.loading.clear();
    }
    replacement.done(problem);
}

// On the thread that reads. Says nothing where another stage waits by now, or none, whose clips are others.
void RenderThread::report_preload(const std::vector<std::filesystem::path>& clips, size_t read) {
    {
        const std::lock_guard lock(mutex_);
        if (state_.loading != clips[read - 1].filename() || state_.files != clips.size()) return;
        state_.loading = clips[read].filename().string();
        state_.files_read = read;
    }
    wake_();
}

// Whether the stage has clips that the one before has not, and that are not read yet: then they are, by a thread, and
// the stage waits. One thread reads at a time; what another stage wants meanwhile is read when it is done.
bool RenderThread::preloads(const Waiting& stage) {
    if (!stage_) return false;
    std::vector<std::filesystem::path> unknown;
    try {
        unknown = edit::clips_of(stage.document->file);
    } catch (const InputError&) {
        return false;  // load() tells what is wrong
    }
    std::erase_if(unknown, [this](const std::filesystem::path& clip) {
        return std::ranges::find(stage_->clips, clip, &stage::StageClip::path) != stage_->clips.end();
    });
    if (unknown.empty() || (preload_ && preload_->is_done() && preload_->clips() == unknown)) return false;
    report_progress(unknown[0].filename().string(), 0, unknown.size());
    waiting_ = stage;
    if (preload_ && !preload_->is_done()) return true;
    const auto each = [this, unknown](size_t read) { report_preload(unknown, read); };
    preload_ = std::make_unique<render::ClipPreload>(loader_->files(), unknown, each, [this] {
        {
            const std::lock_guard lock(mutex_);
            preloaded_ = true;
        }
        changed_.notify_all();
    });
    return true;
}

// The stage that waited is drawn, or told why it cannot be. Nobody may want what was read any more.
void RenderThread::end_preload() {
    const std::optional<Waiting> waiting = std::exchange(waiting_, std::nullopt);
    if (!waiting) {
        if (preload_ && !preload_->is_done()) return;  // it began after the one that this job is about had ended
        preload_.reset();
        const std::lock_guard lock(mutex_);
        state_.loading.clear();
        return;
    }
    if (preloads(*waiting)) return;  // for other clips than those that were read
    const std::unique_ptr<render::ClipPreload> read = std::move(preload_);
    try {
        if (read) read->expect_read();
        load(waiting->document, waiting->id);
        draw_newest();
    } catch (const InputError& error) {
        report_problem(error.what(), is_sound(*waiting->document) ? 0 : waiting->id);
    }
}

// Loads the stage of the document. Keeps the old stage where the new one cannot be drawn.
void RenderThread::load(const std::shared_ptr<const edit::Document>& document, uint64_t id) {
    const auto progress = [&, file = document->file.path.filename().string()](size_t done, size_t of) {
        report_progress(file, done, of);
    };
    const auto before = std::exchange(document_, document);
    try {
        auto stage = std::make_shared<const stage::Stage>(stage::make_stage(document->file, stage_.get()));
        if (renderer_) {
            renderer_->change(*stage, render::with_memory_of_slices(renderer_->frames(),
                                                                    [&] { return loader_->load(*stage, progress); }));
        } else {
            progress(0, stage->clips.size());
            make_renderer(*stage, progress);
        }
        stage_ = std::move(stage);
        stage_id_ = id;
    } catch (const InputError& error) {
        document_ = before;
        return report_problem(error.what(), is_sound(*document) ? 0 : id);
    } catch (...) {
        document_ = before;
        throw;
    }
    {
        const std::lock_guard lock(mutex_);
        state_.loading.clear();
        state_.problem.clear();
        state_.stage = stage_;
        state_.stage_id = id;
        state_.leaf_boxes.clear();
        for (uint32_t clip = 0; clip < stage_->clips.size(); ++clip)
            state_.leaf_boxes.push_back(renderer_->leaf_box(clip));
        state_.displayed.finished = false;
    }
    report_unreadable_segments();
    wake_();
}

// Reports the first of the segments of which it is newly known that they cannot be read.
void RenderThread::report_unreadable_segments() {
    const std::vector<std::string> problems = renderer_->take_problems();
    if (problems.empty()) return;
    const std::lock_guard lock(mutex_);
    state_.problem = problems[0];
}

// Draws the newest view at once, so that a stage that changes all the time is drawn, too.
void RenderThread::draw_newest() {
    {
        const std::lock_guard lock(mutex_);
        if (next_view_) view_ = std::exchange(next_view_, std::nullopt);
    }
    if (stage_ && view_) draw(*view_);
}

void RenderThread::make_renderer(const stage::Stage& stage, const render::StageLoader::Loaded& progress) {
    VkExtent2D capacity = kInitialCapacity;
    {
        const std::lock_guard lock(mutex_);
        if (view_) capacity = {roomy(view_->camera.width), roomy(view_->camera.height)};
        if (next_view_) capacity = {roomy(next_view_->camera.width), roomy(next_view_->camera.height)};
    }
    const render::PaintSource paint = [this](const std::filesystem::path& layer) {
        return voctree::files_of_layer(document_->paint, stage::absolute_path(layer));
    };
    if (!loader_) loader_ = std::make_unique<render::StageLoader>(device_, paint);
    renderer_ = std::make_unique<render::StageRenderer>(device_, stage, loader_->load(stage, progress),
                                                        render::FrameCapacity{capacity.width, capacity.height});
    capacity_ = capacity;
}

}  // namespace neuvv::editor
