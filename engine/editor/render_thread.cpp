#include "editor/render_thread.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/trace_file.h"
#include "editor/blocks.h"

namespace neuvv::editor {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kLookAgain = std::chrono::milliseconds(10);     // for what a view lacks
constexpr auto kRefineDelay = std::chrono::milliseconds(100);  // without a new view; then the view is refined
constexpr auto kPresentTimeout = std::chrono::milliseconds(30);
constexpr VkExtent2D kInitialCapacity{1280, 720};
constexpr uint32_t kCapacityStep = 128;

double milliseconds_since(Clock::time_point from) {
    return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

// The capacity for this many pixels, with room for blocks that are a few rays larger than their share of the image, and
// for windows that grow a little.
uint32_t roomy(uint32_t pixels) {
    return (pixels + 8 + kCapacityStep - 1) / kCapacityStep * kCapacityStep;
}

void add_passes(std::vector<gpu::PassTime>& to, const std::vector<gpu::PassTime>& passes) {
    for (const gpu::PassTime& pass : passes) {
        const auto known = std::find_if(to.begin(), to.end(), [&](const auto& p) { return p.name == pass.name; });
        if (known != to.end())
            known->milliseconds += pass.milliseconds;
        else
            to.push_back(pass);
    }
}

}  // namespace

struct RenderThread::Job {
    std::shared_ptr<const edit::Document> stage;
    uint64_t stage_id = 0;
    std::optional<Replacement> replacement;
    Task task;
    std::optional<ViewRequest> view;
    bool refine = false, look = false;
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

// Waits for the next job and returns it, in this order: the newest stage, new shaders, tasks, the newest view, the next
// block of a view that does not change, idle work. Returns false where the thread must end.
bool RenderThread::wait_for_job(Job& job) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPresentTimeout, [&] { return stop_ || presented_ >= state_.displayed.number; });
    const auto ready = [&] {
        return stop_ || next_stage_ || next_replacement_ ||
               (stage_ && (!tasks_.empty() || next_view_ || !idle_.empty()));
    };
    if ((refinement_ || look_at_) && stage_)
        changed_.wait_until(lock, refinement_ ? refinement_->start : *look_at_, ready);
    else
        changed_.wait(lock, ready);
    if (stop_) return false;
    if (next_stage_) {
        job.stage = std::exchange(next_stage_, nullptr);
        job.stage_id = next_stage_id_;
    } else if (next_replacement_) {
        job.replacement = std::exchange(next_replacement_, std::nullopt);
    } else if (!tasks_.empty()) {
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
        load(job.stage, job.stage_id);
        draw_newest();
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
        for (uint32_t clip = 0; clip < stage_->clips.size(); clip++)
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

// Makes sure that the image and the renderer have at least this size.
void RenderThread::fit(VkExtent2D size) {
    if (size.width + 8 > capacity_.width || size.height + 8 > capacity_.height) {
        capacity_ = {std::max(capacity_.width, roomy(size.width)), std::max(capacity_.height, roomy(size.height))};
        renderer_->resize(capacity_.width, capacity_.height);
    }
    if (image_ && image_->shape.width == capacity_.width && image_->shape.height == capacity_.height) return;
    const gpu::ImageShape shape{
        capacity_.width, capacity_.height, VK_FORMAT_R8G8B8A8_UNORM,
        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT};
    auto created = render::with_memory_of_slices(
        renderer_->frames(), [&] { return std::make_shared<gpu::DeviceImage>(device_, "displayed image", shape); });
    gpu::run_once(device_, "displayed image", [&](gpu::Commands& commands) {
        gpu::move_layout(commands, *created, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    });
    image_ = std::move(created);
}

render::FrameSettings RenderThread::settings_of(const ViewRequest& view, const stage::EvaluatedStage& evaluated) const {
    render::FrameSettings settings = renderer_->settings_at(evaluated, view.highlight);
    const glm::vec4 background = settings.resolve.background;
    settings.resolve = view.resolve;
    if (!view.overrides_background) settings.resolve.background = background;
    settings.width = view.camera.width;
    settings.height = view.camera.height;
    settings.samples = 1;
    settings.far_levels = view.far_levels;
    return settings;
}

// Performers stay as they are shown until what they lack has been read; so does the view.
void RenderThread::look_for_missing() {
    look_at_.reset();
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage_, view_->time_s);
    renderer_->show(evaluated, !view_->overrides_background, render::MissingSegments::kHold);
    report_unreadable_segments();
    if (renderer_->shown(evaluated) != shown_ || renderer_->shows_all(evaluated))
        draw(*view_);
    else
        look_at_ = Clock::now() + kLookAgain;
}

void RenderThread::note_waiting(bool waits, const stage::EvaluatedStage& evaluated) {
    const auto before = std::exchange(shown_, renderer_->shown(evaluated));
    const std::lock_guard lock(mutex_);
    if (!waits) state_.waits_since.reset();
    if (waits && (shown_ != before || !state_.waits_since)) state_.waits_since = Clock::now();
}

void RenderThread::draw(const ViewRequest& view) {
    refinement_.reset();
    look_at_.reset();
    const VkExtent2D size{view.camera.width, view.camera.height};
    if (size.width == 0 || size.height == 0) return;
    fit(size);
    const Clock::time_point begin = Clock::now();
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage_, view.time_s);
    renderer_->show(evaluated, !view.overrides_background, render::MissingSegments::kHold);
    report_unreadable_segments();
    render::FrameSettings settings = settings_of(view, evaluated);
    const bool lacks = !view.moving && !renderer_->shows_all(evaluated);
    note_waiting(lacks || renderer_->holds(evaluated), evaluated);
    settings.scale = std::min(scale_.scale(), view.max_scale);
    settings.next_instances = renderer_->instances_at(view.next_s);
    draw_to_image(view.camera, settings, {0, 0});
    const double milliseconds = milliseconds_since(begin);
    scale_.drawn(settings.scale, milliseconds);

    DisplayedImage displayed{0,
                             view.id,
                             stage_id_,
                             image_,
                             size,
                             settings.scale,
                             view.moving,
                             milliseconds,
                             renderer_->frames().pass_times(),
                             renderer_->frames().live_entries()};
    if (lacks) {
        look_at_ = Clock::now() + kLookAgain;
    } else if (!view.moving) {
        displayed.finished = settings.scale == 1 && view.samples == 1;
        if (!displayed.finished) {
            // First one ray for each pixel, then all rays. A block has no more rays than the renderer has room for,
            // which is one ray per pixel of the image.
            const uint32_t samples = settings.scale < 1 ? 1 : view.samples;
            grid_.begin(samples);
            refinement_ = Refinement{0, samples, begin + kRefineDelay, displayed};
        }
    }
    publish(displayed);
}

// Draws the next block of the view that does not change, with all its rays.
void RenderThread::refine() {
    Refinement& refinement = *refinement_;
    if (refinement.next == 0) {
        refinement.displayed.milliseconds = 0;
        refinement.displayed.passes.clear();
    }
    const uint32_t side = grid_.side();
    const Clock::time_point begin = Clock::now();
    draw_block(*view_, refinement.next, side, refinement.samples);
    const double milliseconds = milliseconds_since(begin);
    refinement.displayed.milliseconds += milliseconds;
    refinement.displayed.scale = refinement.samples;
    add_passes(refinement.displayed.passes, renderer_->frames().pass_times());
    const bool whole = ++refinement.next == side * side;
    refinement.displayed.finished = whole && refinement.samples == view_->samples;
    publish(refinement.displayed);
    if (refinement.displayed.finished) {
        refinement_.reset();
    } else if (whole) {
        refinement.samples = view_->samples;
        grid_.begin(refinement.samples);
        refinement.next = 0;
    } else if (grid_.drawn(milliseconds)) {
        refinement.next = 0;
    }
}

void RenderThread::draw_block(const ViewRequest& view, uint32_t block, uint32_t side, uint32_t samples) {
    const Block part = block_of(view.camera, block, side);
    const stage::Camera& camera = part.camera;
    if (camera.width == 0 || camera.height == 0) return;
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage_, view.time_s);
    renderer_->show(evaluated, !view.overrides_background);  // all is there, unless an export took its place
    render::FrameSettings settings = settings_of(view, evaluated);
    settings.width = camera.width;
    settings.height = camera.height;
    settings.samples = samples;
    draw_to_image(camera, settings, {static_cast<int32_t>(part.left), static_cast<int32_t>(part.top)});
}

// The image, and its copy to a place in image_, in one submission.
void RenderThread::draw_to_image(const stage::Camera& camera, const render::FrameSettings& settings, VkOffset2D at) {
    renderer_->frames().draw({&camera, 1}, settings, [&](gpu::Commands& commands, const gpu::Buffer& pixels) {
        gpu::full_barrier(commands);
        gpu::move_layout(commands, *image_, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.imageOffset = {at.x, at.y, 0};
        region.imageExtent = {camera.width, camera.height, 1};
        vkCmdCopyBufferToImage(commands.handle(), pixels.buffer, image_->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                               &region);
        gpu::move_layout(commands, *image_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    });
}

void RenderThread::publish(DisplayedImage displayed) {
    {
        const std::lock_guard lock(mutex_);
        displayed.number = state_.displayed.number + 1;
        state_.displayed = std::move(displayed);
    }
    wake_();
}

}  // namespace neuvv::editor
