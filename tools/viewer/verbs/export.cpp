#include "tools/viewer/verbs/export.h"
#include "base/output_path.h"

#include <fmt/format.h>

#include <cstring>

#include "base/error.h"
#include "editor/draw/blocks.h"
#include "media/image_sink.h"

namespace neuvv::viewer {

namespace {

// The most rays along a side of a block: tracing it takes some tens of milliseconds on a software device.
constexpr uint32_t kMaxBlockRays = 512;

}  // namespace

Export::Export(ExportSettings settings)
    : settings_(std::move(settings)), image_(settings_.size.width, settings_.size.height) {
    prepare_output_file("export", settings_.output.path);
    if (settings_.output.exr)
        throw InputError("export", settings_.output.path.string(), "the viewer writes no linear images",
                         "choose .png or .mp4, or `neuvv render`");
    if (settings_.output.kind == media::ImageOutput::Kind::kImage && settings_.images > 1)
        throw InputError("export", settings_.output.path.string(), "is one image",
                         "choose an .mp4, or a number as in out_%04d.png");
    if (settings_.output.kind == media::ImageOutput::Kind::kVideo && settings_.heard_stage)
        sound_ = std::make_unique<ExportSound>(
            settings_.heard_stage, settings_.first_s,
            [stage = settings_.heard_stage, camera = settings_.camera](const stage::EvaluatedStage& evaluated) {
                return camera(*stage, evaluated).world_from_camera;
            },
            settings_.is_heard, stop_);
}

std::optional<Export::End> Export::end() const {
    const std::lock_guard lock(mutex_);
    return end_;
}

bool Export::stop(std::string text, bool error) {
    sink_.reset();
    sound_.reset();
    const std::lock_guard lock(mutex_);
    end_ = End{std::move(text), error};
    return false;
}

// Nothing remains of a video, as it is not complete; numbered images remain.
bool Export::stop_cancelled() {
    sound_.reset();  // before the video that it writes to is removed
    std::error_code ignored;
    if (is_drawn()) std::filesystem::remove(settings_.output.path, ignored);
    try {
        if (sink_) sink_->wait();
    } catch (const RuntimeFailure& problem) {
        return stop(problem.what(), true);
    }
    return stop(fmt::format("export cancelled after {} images", finished_images()), false);
}

bool Export::step(editor::OnDevice& on_device) {
    if (stop_.stop_requested()) return stop_cancelled();
    try {
        if (sound_) sound_->expect_readable();
        if (!is_drawn()) draw(on_device);
        if (!is_drawn() || (sound_ && !sound_->add_to(settings_.output.path))) return true;
    } catch (const InputError& problem) {
        return stop(problem.what(), true);
    } catch (const RuntimeFailure& problem) {
        const auto* vulkan = dynamic_cast<const gpu::VulkanError*>(&problem);
        if (vulkan && vulkan->device_lost()) {
            block_ = 0;  // this image begins anew on the device that takes its place
            throw;
        }
        return stop(problem.what(), true);
    }
    return stop(fmt::format("exported {}", settings_.output.path.string()), false);
}

void Export::draw(editor::OnDevice& on_device) {
    if (!sink_)
        sink_ = std::make_unique<media::ImageSink>(settings_.output, settings_.size, settings_.fps,
                                                   media::RenderFacts{}, false);
    draw_block(on_device);
    if (block_ == side_ * side_) finish_image();
}

void Export::draw_block(editor::OnDevice& on_device) {
    const stage::EvaluatedStage evaluated =
        stage::stage_at(on_device.stage, settings_.first_s + finished_ / settings_.fps);
    const stage::Camera camera = settings_.camera(on_device.stage, evaluated);
    on_device.renderer.show(evaluated, settings_.with_background);
    render::FrameSettings settings = on_device.renderer.settings_at(evaluated);
    if (block_ == 0)  // computed once an image: the renderer may grow with the window while an image is drawn
        side_ = editor::min_grid_side(camera, std::min(settings.width, kMaxBlockRays) / settings_.samples,
                                      std::min(settings.height, kMaxBlockRays) / settings_.samples);
    const editor::Block block = editor::block_of(camera, block_++, side_);
    if (block.camera.width == 0 || block.camera.height == 0) return;
    settings.width = block.camera.width;
    settings.height = block.camera.height;
    settings.samples = settings_.samples;
    settings.far_levels = settings_.far_levels;
    if (!settings_.with_background) settings.resolve.background = glm::vec4(0);
    const media::Image drawn = on_device.renderer.frames().render(block.camera, settings);
    for (uint32_t y = 0; y < drawn.height; ++y)
        std::memcpy(image_.at(block.left, block.top + y), drawn.at(0, y), size_t{4} * drawn.width);
}

void Export::finish_image() {
    sink_->add(finished_, image_);
    block_ = 0;
    if (finished_ + 1 == settings_.images) sink_->finish(settings_.images);
    ++finished_;
}

}  // namespace neuvv::viewer
