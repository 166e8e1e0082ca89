#include "editor/draw/view_drawer.h"

#include <algorithm>

#include "editor/draw/blocks.h"

namespace neuvv::editor {

namespace {

using Clock = std::chrono::steady_clock;
constexpr double kMovingTarget_ms = 45;
constexpr auto kLookAgain = std::chrono::milliseconds(10);     // for what a view lacks
constexpr auto kRefineDelay = std::chrono::milliseconds(100);  // without a new view; then the view is refined

double milliseconds_since(Clock::time_point from) {
    return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
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

ViewDrawer::ViewDrawer(const gpu::Device& device, StageOnDevice& stage, RenderState& state)
    : device_(device), stage_(stage), state_(state), scale_(kMovingTarget_ms), grid_(kMovingTarget_ms) {}

void ViewDrawer::release() {
    refinement_.reset();
    look_at_.reset();
    view_.reset();
    image_.reset();
}

std::optional<VkExtent2D> ViewDrawer::size() const {
    if (!view_) return {};
    return VkExtent2D{view_->camera.width, view_->camera.height};
}

std::optional<Clock::time_point> ViewDrawer::due() const {
    return refinement_ ? refinement_->start : look_at_;
}

void ViewDrawer::go_on() {
    if (refinement_)
        refine();
    else
        look_for_missing();
}

void ViewDrawer::draw(ViewRequest view) {
    view_ = std::move(view);
    draw_again();
}

// Makes sure that the image and the renderer have at least this size.
void ViewDrawer::fit(VkExtent2D size) {
    stage_.fit(size);
    const VkExtent2D capacity = stage_.capacity();
    if (image_ && image_->shape.width == capacity.width && image_->shape.height == capacity.height) return;
    const gpu::ImageShape shape{
        capacity.width, capacity.height, VK_FORMAT_R8G8B8A8_UNORM,
        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT};
    auto created = render::with_memory_of_slices(stage_.renderer().frames(), [&] {
        return std::make_shared<gpu::DeviceImage>(device_, "displayed image", shape);
    });
    gpu::run_once(device_, "displayed image", [&](gpu::Commands& commands) {
        gpu::move_layout(commands, *created, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    });
    image_ = std::move(created);
}

render::FrameSettings ViewDrawer::settings_at(const stage::EvaluatedStage& evaluated) const {
    const ViewRequest& view = *view_;
    render::FrameSettings settings = stage_.renderer().settings_at(evaluated, view.highlight);
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
void ViewDrawer::look_for_missing() {
    look_at_.reset();
    const stage::EvaluatedStage evaluated = stage::stage_at(stage_.stage(), view_->time_s);
    stage_.renderer().show(evaluated, !view_->overrides_background, render::MissingSegments::kHold);
    stage_.report_unreadable_segments();
    if (stage_.renderer().shown(evaluated) != shown_ || stage_.renderer().shows_all(evaluated))
        draw_again();
    else
        look_at_ = Clock::now() + kLookAgain;
}

void ViewDrawer::note_waiting(bool waits, const stage::EvaluatedStage& evaluated) {
    const auto before = std::exchange(shown_, stage_.renderer().shown(evaluated));
    state_.change([&](RenderThreadState& state) {
        if (!waits) state.waits_since.reset();
        if (waits && (shown_ != before || !state.waits_since)) state.waits_since = Clock::now();
    });
}

void ViewDrawer::draw_again() {
    refinement_.reset();
    look_at_.reset();
    if (!view_) return;
    const ViewRequest& view = *view_;
    const VkExtent2D size{view.camera.width, view.camera.height};
    if (size.width == 0 || size.height == 0) return;
    fit(size);
    const Clock::time_point begin = Clock::now();
    const stage::EvaluatedStage evaluated = stage::stage_at(stage_.stage(), view.time_s);
    stage_.renderer().show(evaluated, !view.overrides_background, render::MissingSegments::kHold);
    stage_.report_unreadable_segments();
    render::FrameSettings settings = settings_at(evaluated);
    const bool lacks = !view.moving && !stage_.renderer().shows_all(evaluated);
    note_waiting(lacks || stage_.renderer().holds(evaluated), evaluated);
    settings.scale = std::min(scale_.scale(), view.max_scale);
    settings.next_instances = stage_.renderer().instances_at(view.next_s);
    draw_to_image(view.camera, settings, {0, 0});
    const double milliseconds = milliseconds_since(begin);
    scale_.drawn(settings.scale, milliseconds);

    DisplayedImage displayed{0,
                             view.id,
                             stage_.id(),
                             image_,
                             size,
                             settings.scale,
                             view.moving,
                             milliseconds,
                             stage_.renderer().frames().pass_times(),
                             stage_.renderer().frames().live_entries()};
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
    state_.publish(displayed);
}

// Draws the next block of the view that does not change, with all its rays.
void ViewDrawer::refine() {
    Refinement& refinement = *refinement_;
    if (refinement.next == 0) {
        refinement.displayed.milliseconds = 0;
        refinement.displayed.passes.clear();
    }
    const uint32_t side = grid_.side();
    const Clock::time_point begin = Clock::now();
    draw_block(refinement.next, side, refinement.samples);
    const double milliseconds = milliseconds_since(begin);
    refinement.displayed.milliseconds += milliseconds;
    refinement.displayed.scale = refinement.samples;
    add_passes(refinement.displayed.passes, stage_.renderer().frames().pass_times());
    const bool whole = ++refinement.next == side * side;
    refinement.displayed.finished = whole && refinement.samples == view_->samples;
    state_.publish(refinement.displayed);
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

void ViewDrawer::draw_block(uint32_t block, uint32_t side, uint32_t samples) {
    const ViewRequest& view = *view_;
    const Block part = block_of(view.camera, block, side);
    const stage::Camera& camera = part.camera;
    if (camera.width == 0 || camera.height == 0) return;
    const stage::EvaluatedStage evaluated = stage::stage_at(stage_.stage(), view.time_s);
    stage_.renderer().show(evaluated, !view.overrides_background);  // all is there, unless an export took its place
    render::FrameSettings settings = settings_at(evaluated);
    settings.width = camera.width;
    settings.height = camera.height;
    settings.samples = samples;
    draw_to_image(camera, settings, {static_cast<int32_t>(part.left), static_cast<int32_t>(part.top)});
}

// The image, and its copy to a place in image_, in one submission.
void ViewDrawer::draw_to_image(const stage::Camera& camera, const render::FrameSettings& settings, VkOffset2D at) {
    stage_.renderer().frames().draw({&camera, 1}, settings, [&](gpu::Commands& commands, const gpu::Buffer& pixels) {
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

}  // namespace neuvv::editor
