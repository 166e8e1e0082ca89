// neuvv render of a clip.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/output_path.h"
#include "media/image_sink.h"
#include "render/frame_passes.h"
#include "render/linear_image.h"
#include "render/paint.h"
#include "render/reference_paths.h"
#include "tools/render.h"
#include "tools/view_path.h"
#include "training/camera_path_file.h"
#include "voctree/chunk_file.h"
#include "voctree/clip.h"
#include "voctree/nvpaint.h"
#include "voctree/occupied_box.h"

namespace neuvv::tools {

namespace {

// Layers of paint that are read, and how they show.
struct PaintStack {
    std::vector<voctree::EditLayer> layers;
    std::vector<render::PaintUse> uses;  // of the layers, the lowest first
    std::vector<std::string> files;
};

std::optional<stage::PaintBlend> find_blend(const std::string& name) {
    for (size_t i = 0; i < std::size(stage::kPaintBlendNames); i++)
        if (name == stage::kPaintBlendNames[i]) return static_cast<stage::PaintBlend>(i);
    return std::nullopt;
}

stage::PaintBlend parse_blend(const std::string& text) {
    if (const auto blend = find_blend(text)) return *blend;
    throw InputError("--paint", "", fmt::format("there is no blend `{}`", text),
                     "write normal, multiply, tint or recolour");
}

std::optional<double> find_number(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::invalid_argument || end != text.data() + text.size()) return std::nullopt;
    return error == std::errc() ? value : INFINITY;
}

// Refuses a name that is no file, but would be without its part after the last colon: the user means that part as a
// blend or as an opacity.
void expect_blend_or_opacity(const std::string& name, const std::string& last) {
    std::error_code error;
    const bool names_layer = name.find(".nvpaint:") != std::string::npos ||
                             std::filesystem::exists(name.substr(0, name.size() - last.size() - 1), error);
    if (!names_layer || std::filesystem::exists(name, error)) return;
    if (find_number(last)) throw InputError("--paint", name, fmt::format("{} is no opacity", last), "write 0 to 1");
    parse_blend(last);
}

// What stands after the last colon, which a file's name may have, too.
std::optional<std::string> last_part(const std::string& text) {
    const size_t colon = text.rfind(':');
    if (colon == std::string::npos) return std::nullopt;
    return text.substr(colon + 1);
}

// Each name is "layer.nvpaint", "layer.nvpaint:tint" or "layer.nvpaint:tint:0.5"; without them the blend is normal and
// the opacity 1. Throws InputError.
PaintStack read_paint_stack(const std::vector<std::string>& names, const voctree::PaintedField& field) {
    PaintStack stack;
    for (std::string file : names) {
        render::PaintUse use;
        const auto last = last_part(file);
        const auto opacity = last ? find_number(*last) : std::nullopt;
        if (opacity && *opacity >= 0 && *opacity <= 1) {
            file.resize(file.size() - last->size() - 1);
            use.opacity = static_cast<float>(*opacity);
            const auto blend = last_part(file);
            if (!blend) throw InputError("--paint", file, "has an opacity but no blend", "write FILE:normal:0.5");
            use.blend = parse_blend(*blend);
            file.resize(file.size() - blend->size() - 1);
        } else if (last) {
            expect_blend_or_opacity(file, *last);
            if (const auto blend = find_blend(*last)) {
                use.blend = *blend;
                file.resize(file.size() - last->size() - 1);
            }
        }
        stack.layers.push_back(voctree::read_paint(file, field));
        stack.uses.push_back(use);
        stack.files.push_back(file);
    }
    for (size_t i = 0; i < stack.uses.size(); i++) stack.uses[i].layer = &stack.layers[i];
    return stack;
}

// What each image shows. Sets the rate of the output in `playback`, which a camera path may have.
std::vector<ViewStep> view_path(const RenderOptions& options, const voctree::VOctree& tree, Playback& playback,
                                media::ImageSize size) {
    playback.output_fps = checked_fps(options, 0, playback.clip_fps);
    if (options.camera.empty()) return orbit_path(voctree::occupied_box(tree), playback, size.width ? size : kClipSize);
    const stage::CameraPath path = training::read_camera_path(options.camera, playback.output_fps);
    playback.output_fps = checked_fps(options, path.fps, playback.clip_fps);
    return path_steps(path, playback, tree.frames, size, kClipSize);
}

// What is rendered. All of it is known, and wrong options are refused, before the device is opened.
struct RenderPlan {
    media::ImageOutput output;
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
    plan.output = media::parse_output(options.output);
    plan.resolve = resolve_settings(options, plan.output);
    expect_fitting_output(plan.output, options);
    prepare_output_file("--output", plan.output.path);
    const media::ImageSize given_size = options.size.empty() ? media::ImageSize{} : parse_size(options.size);
    plan.tree = voctree::read_clip(options.scene);
    plan.paint = read_paint_stack(options.paint, voctree::painted_field(plan.tree));
    const double clip_fps = plan.tree.fps;
    plan.playback = {parse_frame_range(options.frames, plan.tree.frames), clip_fps, clip_fps};
    plan.path = view_path(options, plan.tree, plan.playback, given_size);
    const bool one_time = plan.playback.range.first == plan.playback.range.last;
    if (one_time && plan.output.kind == media::ImageOutput::Kind::kImage && options.camera.empty())
        plan.path.resize(1);  // a still: the orbit's first view
    expect_fitting_output(plan.output, plan.path.size());
    const auto [near, far] = depth_range(plan.path, voctree::occupied_box(plan.tree));
    plan.resolve.depth_near_m = static_cast<float>(near);
    plan.resolve.depth_far_m = static_cast<float>(far);
    plan.size = {plan.path[0].camera.width, plan.path[0].camera.height};
    plan.samples = samples_of(options);
    return plan;
}

// Adds the last image of a renderer to the sink.
template <typename Renderer>
FrameTimes add_image(const Renderer& renderer, const media::Image& image, const RenderPlan& plan, uint32_t i,
                     media::ImageSink& sink) {
    if (sink.exr())
        sink.add(i, render::linear_image(renderer.radiance(), renderer.depth(), plan.size.width, plan.size.height,
                                         plan.samples, plan.resolve.background));
    else
        sink.add(i, image);
    return times_of(renderer);
}

FrameTimes render_image(render::FrameRenderer& renderer, const RenderOptions& options, const RenderPlan& plan,
                        uint32_t paint, uint32_t i, media::ImageSink& sink) {
    render::FrameSettings settings;
    settings.instances[0].frame = static_cast<float>(plan.path[i].frame);
    settings.instances[0].paint = paint;
    settings.width = plan.size.width;
    settings.height = plan.size.height;
    settings.samples = plan.samples;
    settings.scale = options.scale;
    settings.resolve = plan.resolve;
    settings.mode = render::TraceMode::kPlay;
    settings.far_levels = options.far_levels.value_or(true);
    const media::Image image = renderer.render(plan.path[i].camera, settings);
    return add_image(renderer, options.pass.empty() ? image : pass_image(options, renderer, i), plan, i, sink);
}

FrameTimes render_directly(render::ReferenceRenderer& renderer, const RenderPlan& plan, uint32_t i,
                           media::ImageSink& sink) {
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
    if (options.blend || options.shadows || options.falloff)
        throw InputError("--blend, --shadows, --falloff", options.scene, "are for stages", fix);
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
    media::RenderFacts facts = render_facts(options, plan.playback.output_fps, size, images);
    facts["scene"] = media::content_fact(options.scene);
    facts["--camera"] = options.camera.empty() ? "orbit" : media::content_fact(options.camera);
    facts["--frames"] = fmt::format("{}:{}", plan.playback.range.first, plan.playback.range.last);
    for (size_t i = 0; i < plan.paint.files.size(); i++)
        facts["--paint " + options.paint[i]] = media::content_fact(plan.paint.files[i]);
    facts["--direct"] = fmt::format("{}", options.direct);
    media::ImageSink sink(plan.output, size, plan.playback.output_fps, facts, options.resume);
    const gpu::Device device(common.device);
    const render::Field field = render::upload_far_levels(device, plan.tree);
    const auto render_all = [&](const std::function<FrameTimes(uint32_t)>& render) {
        return render_images(options, plan.output, size, plan.playback.output_fps, images, sink, device, render);
    };
    if (options.direct) {
        render::ReferenceRenderer renderer(device, field, size.width, size.height, plan.samples);
        return render_all([&](uint32_t i) { return render_directly(renderer, plan, i, sink); });
    }
    const uint64_t slice_bytes = bytes_of_mebibytes(options.slice_budget_mb);
    render::FrameRenderer renderer(device, field, {size.width, size.height, plan.samples, 1, slice_bytes});
    const uint32_t paint = plan.paint.uses.empty() ? 0 : renderer.paints().add(plan.paint.uses);
    return render_all([&](uint32_t i) { return render_image(renderer, options, plan, paint, i, sink); });
}

}  // namespace neuvv::tools
