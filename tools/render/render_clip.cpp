// neuvv render of a clip.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/output_path.h"
#include "interchange/camera/camera_path_file.h"
#include "media/image_sink.h"
#include "render/clips/segment_paint.h"
#include "render/clips/shown_segments.h"
#include "render/clips/uploaded_segment.h"
#include "render/frame/frame_passes.h"
#include "render/rays/linear_image.h"
#include "render/volume/reference_paths.h"
#include "render/volume/slices/paint.h"
#include "tools/render/render.h"
#include "tools/render/render_layers.h"
#include "tools/view_path.h"
#include "voctree/files/chunk_file.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_box.h"
#include "voctree/files/clip_index.h"
#include "voctree/files/nvpaint.h"
#include "voctree/files/occupied_box.h"
#include "voctree/kinds/clip_source.h"

namespace neuvv::tools {

namespace {

// The layers of --paint, the lowest first. Those of a clip that is one file are read; of a clip in segments, they are
// folders, of which each segment's part is read with the segment.
struct PaintStack {
    render::LayerFolders names;
    std::vector<voctree::EditLayer> layers;  // empty for a clip in segments
};

std::optional<stage::PaintBlend> find_blend(const std::string& name) {
    for (size_t i = 0; i < std::size(stage::kPaintBlendNames); ++i)
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
render::LayerFolders parse_paint(const std::vector<std::string>& names) {
    render::LayerFolders layers;
    for (std::string file : names) {
        render::LayerFolder use;
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
        use.folder = file;
        layers.push_back(use);
    }
    return layers;
}

// What is rendered. All of it is known, and wrong options are refused, before the device is opened.
struct RenderPlan {
    media::ImageOutput output;
    ExrLayers layers;
    render::ResolveSettings resolve;
    voctree::ClipIndex clip;
    std::pair<glm::dvec3, glm::dvec3> box;  // around the leaves
    PaintStack paint;
    // Of a clip that is one file with bases, which was read for its box and paint.
    std::shared_ptr<const voctree::SegmentContent> content;
    Playback playback;
    std::vector<ViewStep> path;
    media::ImageSize size;
    uint32_t samples = 1;
};

// Whether one image is meant: a single file, and one frame, or none named.
bool wants_still(const RenderOptions& options, const RenderPlan& plan, const Playback& playback) {
    const bool one_time = options.frames.empty() || playback.range.first == playback.range.last;
    return one_time && plan.output.kind == media::ImageOutput::Kind::kImage;
}

// What each image shows. Sets the rate of the output in `playback`, which a camera path may have. A still has the first
// view of the orbit, or that of a fixed camera.
std::vector<ViewStep> view_path(const RenderOptions& options, const RenderPlan& plan, Playback& playback,
                                media::ImageSize size) {
    const bool still = wants_still(options, plan, playback);
    playback.output_fps = checked_fps(options, 0, playback.clip_fps);
    if (options.camera.empty()) {
        std::vector<ViewStep> steps = orbit_path(plan.box, playback, size.width ? size : kClipSize);
        if (still) steps.resize(1);
        return steps;
    }
    const stage::CameraPath path =
        interchange::read_camera_path(options.camera, playback.output_fps, voctree::read_world_frame(options.scene));
    playback.output_fps = checked_fps(options, path.fps, playback.clip_fps);
    std::vector<ViewStep> steps = path_steps(path, playback, plan.clip.frames(), size, kClipSize);
    if (still && path.keys.size() == 1) steps.resize(1);
    return steps;
}

// Reads what is known of a clip before any of its segments is on the device.
void read_scene(const RenderOptions& options, RenderPlan& plan) {
    plan.clip = voctree::read_clip_index(options.scene, up_of(options.scene, options.up));
    plan.paint.names = parse_paint(options.paint);
    const voctree::ClipSegment& first = plan.clip.segments[0];
    if (!plan.paint.names.empty()) first.source->expect_paintable();
    if (plan.clip.segments.size() > 1 || first.source->plays_by_frame()) {
        for (const render::LayerFolder& one : plan.paint.names) voctree::expect_paint_folder(one.folder);
        plan.box = voctree::occupied_box(plan.clip);
        return;
    }
    plan.content = std::make_shared<const voctree::SegmentContent>(
        first.source->content(first, stream::kShFine, voctree::PlenoctreeColours::kAsStored));
    const auto& tree = std::get<voctree::VOctree>(*plan.content);
    plan.box = voctree::occupied_box(tree);
    if (plan.paint.names.empty()) return;
    const voctree::PaintedField field = voctree::painted_field(tree);
    for (const render::LayerFolder& one : plan.paint.names)
        plan.paint.layers.push_back(voctree::read_paint(one.folder, field));
}

RenderPlan plan_render(const RenderOptions& options) {
    RenderPlan plan;
    plan.output = media::parse_output(options.output);
    plan.resolve = resolve_settings(options, plan.output);
    expect_fitting_output(plan.output, options);
    prepare_output_file("--output", plan.output.path);
    plan.layers = parse_layers(options.layers);
    plan.output.has_deep = plan.layers.deep;
    const media::ImageSize given_size = options.size.empty() ? media::ImageSize{} : parse_size(options.size);
    read_scene(options, plan);
    const double clip_fps = plan.clip.fps;
    plan.playback = {parse_frame_range(options.frames, plan.clip.frames()), clip_fps, clip_fps};
    plan.path = view_path(options, plan, plan.playback, given_size);
    expect_fitting_output(plan.output, plan.path.size());
    const auto [near, far] = depth_range(plan.path, plan.box);
    plan.resolve.depth_near_m = static_cast<float>(near);
    plan.resolve.depth_far_m = static_cast<float>(far);
    plan.size = {plan.path[0].camera.width, plan.path[0].camera.height};
    plan.samples = samples_of(options);
    return plan;
}

template <typename Renderer>
media::LinearImage linear_image_of(const Renderer& renderer, const RenderPlan& plan, uint32_t i) {
    return render::linear_image(renderer.radiance(), renderer.depth(), plan.path[i].camera, plan.samples,
                                plan.resolve.background);
}

// What segments may take that are not shown, as an orbit shows them again where it is longer than the clip: at most a
// quarter of the memory that this process may still take.
uint64_t kept_bytes(const gpu::Device& device) {
    constexpr uint64_t kMostKept_bytes = uint64_t{1} << 30;
    const gpu::HeapMemory memory = device.memory();
    const uint64_t budget = memory.budget.value_or(memory.size / 4);
    return std::min(kMostKept_bytes, (budget - std::min(budget, memory.used)) / 4);
}

// Draws the images of a plan with the passes that play clips.
class PlayingRenderer {
  public:
    // Frees plan.content once it is on the device.
    PlayingRenderer(const gpu::Device& device, const RenderOptions& options, RenderPlan& plan)
        : device_(device),
          options_(options),
          plan_(plan),
          segments_(
              plan.clip,
              [&](const voctree::ClipSegment& segment, uint32_t number) {
                  const auto content = std::exchange(plan.content, nullptr);
                  render::UploadedSegment uploaded =
                      content ? render::upload_content(device, *content) : render::upload_segment(device, segment);
                  paints_[number] = {load_paint(number, uploaded.painted), 0};
                  return std::move(uploaded.field);
              },
              kept_bytes(device)) {}

    FrameTimes render(uint32_t i, media::ImageSink& sink) {
        render::FrameSettings settings;
        settings.instances = segments_.show(voctree::segment_shares(plan_.clip, plan_.path[i].frame),
                                            [this](const auto& fields) { use(fields); });
        for (render::Instance& instance : settings.instances)
            instance.paint = paints_[segments_.segment_of(instance.field)].number;
        settings.width = plan_.size.width;
        settings.height = plan_.size.height;
        settings.samples = plan_.samples;
        settings.scale = options_.scale;
        settings.resolve = plan_.resolve;
        settings.mode = render::TraceMode::kPlay;
        settings.far_levels = options_.far_levels.value_or(true);
        media::Image image = renderer_->render(plan_.path[i].camera, settings);
        const FrameTimes times = times_of(*renderer_);
        if (sink.exr()) {
            const std::string name = std::filesystem::path(options_.scene).stem().string();
            add_layers(sink, i, plan_.layers, linear_image_of(*renderer_, plan_, i), *renderer_, plan_.path[i].camera,
                       settings, {&name, 1});
        } else {
            sink.add(i, options_.pass.empty() ? std::move(image) : pass_image(options_, *renderer_, i));
        }
        return times;
    }

  private:
    // Null where there is none.
    std::shared_ptr<const render::Paint> load_paint(uint32_t segment, const voctree::PaintedField& field) const {
        const PaintStack& stack = plan_.paint;
        if (stack.names.empty()) return nullptr;
        if (stack.layers.empty())
            return render::load_segment_paint(device_, stack.names, plan_.clip.segments[segment], field);
        std::vector<render::PaintUse> uses;
        for (size_t i = 0; i < stack.layers.size(); ++i)
            uses.push_back({&stack.layers[i], stack.names[i].blend, stack.names[i].opacity});
        return std::make_shared<const render::Paint>(device_, field.leaf_count, uses);
    }
    void use(const std::vector<const render::Field*>& fields) {
        const bool is_first = !renderer_;
        if (is_first)
            renderer_.emplace(device_, fields,
                              render::FrameCapacity{plan_.size.width, plan_.size.height, plan_.samples, 1,
                                                    bytes_of_mebibytes(options_.slice_budget_mb)});
        // Two segments are shown while one fades into the next: slices stay where their share of the budget does.
        const bool fades = std::ranges::any_of(plan_.clip.segments, &voctree::ClipSegment::overlap);
        if (fades || !is_first) renderer_->change_fields(fields, fades ? 2 : 1);
        std::erase_if(paints_, [&](const auto& one) { return !segments_.holds(one.first); });
        for (auto& [segment, paint] : paints_) {
            bool is_shown = false;
            for (uint32_t i = 0; i < fields.size(); ++i) is_shown |= segments_.segment_of(i) == segment;
            if (!is_shown) paint.number = 0;  // the renderer has dropped it with the field
        }
        for (uint32_t i = 0; i < fields.size(); ++i) {
            NumberedPaint& of_field = paints_[segments_.segment_of(i)];
            if (of_field.paint && of_field.number == 0) of_field.number = renderer_->paints(i).add(of_field.paint);
        }
    }
    const gpu::Device& device_;
    const RenderOptions& options_;
    const RenderPlan& plan_;
    struct NumberedPaint {
        std::shared_ptr<const render::Paint> paint;
        uint32_t number = 0;  // in the renderer; 0: it has none, or not yet
    };
    std::map<uint32_t, NumberedPaint> paints_;  // by segment, of those that are on the device
    render::ShownSegments segments_;
    std::optional<render::FrameRenderer> renderer_;
};

// Draws the images of a plan by the paper's walk. It has one field, so that segments do not fade into each other.
class DirectRenderer {
  public:
    // Frees plan.content once it is on the device.
    DirectRenderer(const gpu::Device& device, RenderPlan& plan)
        : device_(device), plan_(plan), segments_(plan.clip, [&](const voctree::ClipSegment& segment, uint32_t) {
              if (const auto content = std::exchange(plan.content, nullptr))
                  return render::upload_field(device, std::get<voctree::VOctree>(*content),
                                              render::WeightPrecision::kHalf);
              // A frame of a stream, too, has weights for it.
              return render::upload_field(device, voctree::read_shown_segment(segment), render::WeightPrecision::kHalf);
          }) {}

    FrameTimes render(uint32_t i, media::ImageSink& sink) {
        render::ReferenceSettings settings;
        settings.path = render::ReferencePath::kDirect;
        const voctree::SegmentFrame at = voctree::segment_frame(plan_.clip, plan_.path[i].frame);
        segments_.show({{at}}, [this](const auto& fields) {
            renderer_.emplace(device_, *fields[0], plan_.size.width, plan_.size.height, plan_.samples);
        });
        settings.frame = at.frame;
        settings.samples = plan_.samples;
        settings.resolve = plan_.resolve;
        media::Image image = renderer_->render(plan_.path[i].camera, settings);
        if (!sink.exr()) {
            sink.add(i, std::move(image));
            return times_of(*renderer_);
        }
        media::LinearImage linear = linear_image_of(*renderer_, plan_, i);
        remove_unwanted(linear, plan_.layers);
        sink.add(i, std::move(linear));
        return times_of(*renderer_);
    }

  private:
    const gpu::Device& device_;
    const RenderPlan& plan_;
    render::ShownSegments segments_;
    std::optional<render::ReferenceRenderer> renderer_;
};

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
    if (std::filesystem::exists(options.scene) && voctree::kind_of(options.scene) == voctree::ClipKind::kNvv &&
        voctree::content_of(options.scene) == voctree::FileContent::kOther)
        throw InputError(options.scene, "", "is neither a clip nor a stage",
                         "name a .nvv of `neuvv train`, a .nvs of `neuvv publish`, the .npz of a PlenOctree, or a "
                         ".gltf or .glb of `neuvv stage`");
    expect_no_stage_options(options);
    RenderPlan plan = plan_render(options);
    const media::ImageSize size = plan.size;
    const auto images = static_cast<uint32_t>(plan.path.size());
    if (options.plan) return planned(options, plan.output, images, size, plan.playback.output_fps);
    media::RenderFacts facts = render_facts(options, plan.playback.output_fps, size, images);
    add_clip_facts(facts, "scene", options.scene);
    facts["--camera"] = options.camera.empty() ? "orbit" : media::content_fact(options.camera);
    facts["--frames"] = fmt::format("{}:{}", plan.playback.range.first, plan.playback.range.last);
    for (size_t i = 0; i < plan.paint.names.size(); ++i)
        add_layer_facts(facts, "--paint " + options.paint[i], plan.paint.names[i].folder);
    if (options.up) facts["--up"] = *options.up == voctree::UpAxis::kY ? "y" : "z";
    facts["--direct"] = fmt::format("{}", options.direct);
    expect_new_images(options, plan.output, images);
    const RenderPart part(part_number(options.part, ranks_of_environment()), plan.output, facts, images,
                          options.resume);
    if (options.resume && part.is_there()) return conclude_part(options, part, size, plan.playback.output_fps);
    media::ImageSink sink(part.output(), size, plan.playback.output_fps, facts, options.resume, part.range());
    const gpu::Device device(device_of(common));
    const auto render_all = [&](auto renderer) {
        return render_images(options, size, plan.playback.output_fps, part, sink, device,
                             [&](uint32_t i) { return renderer->render(i, sink); });
    };
    if (options.direct) return render_all(std::make_unique<DirectRenderer>(device, plan));
    return render_all(std::make_unique<PlayingRenderer>(device, options, plan));
}

}  // namespace neuvv::tools
