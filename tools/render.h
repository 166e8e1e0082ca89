// What a user may set of `neuvv render`, and what rendering a clip (render_clip.cpp) and a stage (render_stage.cpp)
// share.
#pragma once

#include <functional>
#include <optional>

#include "render/frame.h"
#include "stage/stage_settings.h"
#include "tools/commands.h"
#include "tools/image_sink.h"

namespace neuvv::tools {

struct RenderOptions {
    std::string scene, output, camera, frames, size, background;
    std::string pass;                // the intermediate buffer to show, of frame_passes(); empty: the frame itself
    std::vector<std::string> paint;  // layers, of a clip
    std::optional<double> fps;       // the clip's or the stage's where not given
    uint32_t samples = kDefaultSamples;
    double scale = 1;
    double slice_budget_mb = static_cast<double>(render::kSliceBudget >> 20);
    bool orbit = false, depth = false, alpha = false, level = false, cost = false;
    double cost_max = double{render::ResolveSettings{}.cost_max};
    bool direct = false, resume = false, json = false;
    bool capture = false;  // the first image, by RenderDoc
    // Of a stage: seconds, "A:B"; and what stands in for its own settings.
    std::string time;
    std::optional<stage::StageBlend> blend;
    std::optional<bool> shadows, falloff;
};

struct RenderTotals {
    size_t images = 0, rendered = 0;
    media::ImageSize size;
    double fps = 0, rays = 0, seconds = 0;
};

RenderTotals render_clip(const RenderOptions& options, const CommonOptions& common);
RenderTotals render_stage(const RenderOptions& options, const CommonOptions& common);

// What the images show, as the output can hold it: a video no transparency, an .exr no image of depth and the like.
// Throws InputError.
render::ResolveSettings resolve_settings(const RenderOptions& options, const ImageOutput& output);
void expect_fitting_output(const ImageOutput& output, const RenderOptions& options);
void expect_fitting_output(const ImageOutput& output, size_t images);
// That of --fps, else of the camera path where it has one, else `otherwise`.
double checked_fps(const RenderOptions& options, double path_fps, double otherwise);
inline uint32_t samples_of(const RenderOptions& options) {
    return options.scale < 1 ? 1 : options.samples;
}

// All that the images depend on but scene, camera and device, whose rounding nobody sees.
RenderFacts render_facts(const RenderOptions& options, double fps, media::ImageSize size, size_t images);

// How long a frame took: from its submission until it was there, and each pass on the device.
struct FrameTimes {
    double milliseconds = 0;
    std::vector<gpu::PassTime> passes;
};
template <typename Renderer>
FrameTimes times_of(const Renderer& renderer) {
    return {renderer.milliseconds(), renderer.pass_times()};
}

// The buffer of --pass that the frame has just left, as an image; tells its range.
media::Image pass_image(const RenderOptions& options, const render::FrameRenderer& renderer, uint32_t i);

// The images that the sink has not, one after the other: `render` puts image i into it. Throws RuntimeFailure where
// the user stops it.
RenderTotals render_images(const RenderOptions& options, const ImageOutput& output, media::ImageSize size, double fps,
                           uint32_t images, ImageSink& sink, const gpu::Device& device,
                           const std::function<FrameTimes(uint32_t)>& render);

}  // namespace neuvv::tools
