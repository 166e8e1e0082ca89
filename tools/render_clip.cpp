// neuvv render of one clip.
#include <fmt/format.h>

#include "base/error.h"
#include "render/frame_passes.h"
#include "render/linear_image.h"
#include "render/reference_paths.h"
#include "tools/paint_layers.h"
#include "tools/render_job.h"
#include "tools/view_path.h"
#include "training/camera_path_file.h"
#include "voctree/chunk_file.h"
#include "voctree/clip.h"

namespace neuvv::tools {

namespace {

// Sets the rate of `playback`, which the path may have.
std::vector<ViewStep> view_path(const RenderOptions& options, const voctree::VOctree& tree, Playback& playback,
                                media::ImageSize size) {
    playback.output_fps = checked_fps(options, 0, playback.clip_fps);
    if (options.camera.empty()) return orbit_path(occupied_box(tree), playback, size.width ? size : kClipSize);
    const stage::CameraPath path = training::read_camera_path(options.camera, playback.output_fps);
    playback.output_fps = checked_fps(options, path.fps, playback.clip_fps);
    return path_steps(path, playback, tree.frames, size, kClipSize);
}

// What is rendered, all of it known before the device is touched.
struct RenderPlan {
    ImageOutput output;
    render::ResolveSettings resolve;
    voctree::VOctree tree;
    PaintStack paint;
    Playback playback;
    std::vector<ViewStep> path;
    media::ImageSize size;
    uint32_t samples = 1;
};

RenderPlan plan_render(const RenderOptions& options) {
    RenderPlan plan;
    plan.output = parse_output(options.output);
    plan.resolve = resolve_settings(options, plan.output);
    expect_fitting_output(plan.output, options);
    prepare_output_file("--output", plan.output.path);
    const media::ImageSize wanted = options.size.empty() ? media::ImageSize{} : parse_size(options.size);
    plan.tree = voctree::read_clip(options.scene);
    plan.paint = read_paint_stack(options.paint, voctree::painted_field(plan.tree));
    const double clip_fps = plan.tree.fps;
    plan.playback = {parse_frame_range(options.frames, plan.tree.frames), clip_fps, clip_fps};
    plan.path = view_path(options, plan.tree, plan.playback, wanted);
    const bool evaluated = plan.playback.range.first == plan.playback.range.last;
    if (evaluated && plan.output.kind == ImageOutput::Kind::kImage && options.camera.empty())
        plan.path.resize(1);  // a still: the orbit's first view
    expect_fitting_output(plan.output, plan.path.size());
    const auto [near, far] = depth_range(plan.path, occupied_box(plan.tree));
    plan.resolve.depth_near_m = static_cast<float>(near);
    plan.resolve.depth_far_m = static_cast<float>(far);
    plan.size = {plan.path[0].camera.width, plan.path[0].camera.height};
    plan.samples = samples_of(options);
    return plan;
}

// What the renderer has just drawn.
template <typename Renderer>
FrameTimes add_image(const Renderer& renderer, const media::Image& image, const RenderPlan& plan, uint32_t i,
                     ImageSink& sink) {
    if (sink.exr())
        sink.add(i, render::linear_image(renderer.radiance(), renderer.depth(), plan.size.width, plan.size.height,
                                         plan.samples, plan.resolve.background));
    else
        sink.add(i, image);
    return times_of(renderer);
}

FrameTimes render_image(render::FrameRenderer& renderer, const RenderOptions& options, const RenderPlan& plan,
                        uint32_t paint, uint32_t i, ImageSink& sink) {
    render::FrameSettings settings;
    settings.instances[0].frame = static_cast<float>(plan.path[i].frame);
    settings.instances[0].paint = paint;
    settings.width = plan.size.width;
    settings.height = plan.size.height;
    settings.samples = plan.samples;
    settings.scale = options.scale;
    settings.resolve = plan.resolve;
    settings.mode = render::TraceMode::kPlay;
    const media::Image image = renderer.render(plan.path[i].camera, settings);
    return add_image(renderer, options.pass.empty() ? image : pass_image(options, renderer, i), plan, i, sink);
}

FrameTimes render_directly(render::ReferenceRenderer& renderer, const RenderPlan& plan, uint32_t i, ImageSink& sink) {
    render::ReferenceSettings settings;
    settings.path = render::ReferencePath::kDirect;
    settings.frame = static_cast<float>(plan.path[i].frame);
    settings.samples = plan.samples;
    settings.resolve = plan.resolve;
    return add_image(renderer, renderer.render(plan.path[i].camera, settings), plan, i, sink);
}

void expect_no_stage_options(const RenderOptions& options) {
    const char* fix = "leave it out, or render a stage (neuvv stage new)";
    if (!options.time.empty()) throw InputError("--time", options.time, "is for stages", "choose --frames of a clip");
    if (options.blend) throw InputError("--blend", *options.blend, "is for stages", fix);
    if (options.shadows) throw InputError("--shadows", *options.shadows, "is for stages", fix);
    if (options.falloff) throw InputError("--falloff", *options.falloff, "is for stages", fix);
    if (!options.pass.empty() && render::find_frame_pass(options.pass)->needs_set)
        throw InputError("--pass", options.pass, "is for stages", fix);
}

}  // namespace

RenderTotals render_clip(const RenderOptions& options, const CommonOptions& common) {
    if (std::filesystem::exists(options.scene) && voctree::content_of(options.scene) == voctree::FileContent::kOther &&
        !voctree::is_plenoctree(options.scene))
        throw InputError(options.scene, "", "is neither a clip nor a stage",
                         "name a .nvv of `neuvv train`, the .npz of a PlenOctree, or a .gltf or .glb of `neuvv stage`");
    expect_no_stage_options(options);
    const RenderPlan plan = plan_render(options);
    const media::ImageSize size = plan.size;
    const auto images = static_cast<uint32_t>(plan.path.size());
    RenderFacts facts = render_facts(options, plan.playback.output_fps, size, images);
    facts["scene"] = content_fact(options.scene);
    facts["--camera"] = options.camera.empty() ? "orbit" : content_fact(options.camera);
    facts["--frames"] = fmt::format("{}:{}", plan.playback.range.first, plan.playback.range.last);
    for (size_t i = 0; i < plan.paint.files.size(); i++)
        facts["--paint " + options.paint[i]] = content_fact(plan.paint.files[i]);
    facts["--direct"] = fmt::format("{}", options.direct);
    ImageSink sink(plan.output, size, plan.playback.output_fps, facts, options.resume);
    const gpu::Device device(common.device);
    const render::Field field = render::upload_field(device, plan.tree, render::WeightPrecision::kHalf);
    const auto render_all = [&](const std::function<FrameTimes(uint32_t)>& render) {
        return render_images(options, plan.output, size, plan.playback.output_fps, images, sink, device, render);
    };
    if (options.direct) {
        render::ReferenceRenderer renderer(device, field, size.width, size.height, plan.samples);
        return render_all([&](uint32_t i) { return render_directly(renderer, plan, i, sink); });
    }
    const auto slice_bytes = static_cast<uint64_t>(options.slice_budget_mb * 1048576);
    render::FrameRenderer renderer(device, field, {size.width, size.height, plan.samples, 1, slice_bytes});
    const uint32_t paint = plan.paint.uses.empty() ? 0 : renderer.paints().add(plan.paint.uses);
    return render_all([&](uint32_t i) { return render_image(renderer, options, plan, paint, i, sink); });
}

}  // namespace neuvv::tools
