// What a user may set of `neuvv render`, and what rendering a clip (render_clip.cpp) and a stage (render_stage.cpp)
// share.
#pragma once

#include <functional>
#include <optional>

#include "media/image_sink.h"
#include "render/frame/frame_renderer.h"
#include "stage/stage_settings.h"
#include "tools/commands.h"
#include "tools/render/render_part.h"

namespace neuvv::tools {

struct RenderOptions {
    std::string scene, output, camera, frames, size, background;
    std::string part;                // "2/8": the second of eight parts of the images; empty: all, or by the ranks
    std::string layers;              // of an .exr: parse_layers
    std::string pass;                // the intermediate buffer to show, of frame_passes(); empty: the frame itself
    std::vector<std::string> paint;  // layers, of a clip
    std::optional<voctree::UpAxis> up;
    std::optional<double> fps;  // nothing: the camera path's, the clip's or the stage's
    uint32_t samples = kDefaultSamples;
    double scale = 1;
    double slice_budget_mb = static_cast<double>(render::kSliceBudget >> 20);
    std::optional<bool> far_levels;  // nothing: on
    bool orbit = false, depth = false, alpha = false, level = false, cost = false;
    double cost_max = double{render::ResolveSettings{}.cost_max};
    bool direct = false, resume = false, plan = false, json = false;
    bool capture = false;  // whether RenderDoc captures the first image
    // Of a stage: seconds, "A:B"; and settings that replace the stage's own.
    std::string time;
    std::optional<stage::StageBlend> blend;
    std::optional<bool> shadows, falloff;
};

struct RenderTotals {
    size_t images = 0, rendered = 0;  // images of the part; of --plan, of all parts
    media::ImageSize size;
    double fps = 0, rays = 0, seconds = 0;
};

RenderTotals render_clip(const RenderOptions& options, const CommonOptions& common);
RenderTotals render_stage(const RenderOptions& options, const CommonOptions& common);

// What the images show. Throws InputError where a video would have to be transparent.
render::ResolveSettings resolve_settings(const RenderOptions& options, const media::ImageOutput& output);
// Throws InputError where the options ask for what the output cannot be, for instance an .exr of --depth.
void expect_fitting_output(const media::ImageOutput& output, const RenderOptions& options);
// Throws InputError where images of the process's part would replace others, unless --overwrite says so, or --resume
// goes on with a render that was begun.
void expect_new_images(const RenderOptions& options, const media::ImageOutput& output, uint32_t images);
// Throws InputError where the output is one file for several images.
void expect_fitting_output(const media::ImageOutput& output, size_t images);
// The rate of --fps, else of the camera path where it has one (not 0), else `fallback`. Throws InputError for a --fps
// that is no rate.
double checked_fps(const RenderOptions& options, double path_fps, double fallback);
// Rays a pixel along each side.
inline uint32_t samples_of(const RenderOptions& options) {
    return options.scale < 1 ? 1 : options.samples;
}

// What the images depend on, without scene and camera. The device is left out, as its rounding is not visible.
media::RenderFacts render_facts(const RenderOptions& options, double fps, media::ImageSize size, size_t images);

// Adds the content of a clip's files, under the given name.
void add_clip_facts(media::RenderFacts& facts, const std::string& name, const std::filesystem::path& clip);
// The same of a layer of paint, which is a file or, on a clip in segments, a folder.
void add_layer_facts(media::RenderFacts& facts, const std::string& name, const std::filesystem::path& layer);

// How long a frame took from its submission to its end, by the host's clock, and each pass on the device.
struct FrameTimes {
    double milliseconds = 0;
    std::vector<gpu::PassTime> passes;
};
template <typename Renderer>
FrameTimes times_of(const Renderer& renderer) {
    return {renderer.milliseconds(), renderer.pass_times()};
}

// The buffer of --pass of the last frame as an image; prints the range of its values.
media::Image pass_image(const RenderOptions& options, const render::FrameRenderer& renderer, uint32_t i);

// The device of this process, which may render a part of what others render, too.
std::string device_of(const CommonOptions& common);

// Says what became of the part, whose images are all written; joins the parts of a video if no other is missing.
// Returns the totals of a run that rendered nothing.
RenderTotals conclude_part(const RenderOptions& options, const RenderPart& part, media::ImageSize size, double fps);
// What --plan says of a render. Throws InputError where its parts are more than its images.
RenderTotals planned(const RenderOptions& options, const media::ImageOutput& output, uint32_t images,
                     media::ImageSize size, double fps);

// Renders the images of the part that the sink does not have yet, one after the other: `render` adds image i to it.
// Throws RuntimeFailure where the user stops it.
RenderTotals render_images(const RenderOptions& options, media::ImageSize size, double fps, const RenderPart& part,
                           media::ImageSink& sink, const gpu::Device& device,
                           const std::function<FrameTimes(uint32_t)>& render);

}  // namespace neuvv::tools
