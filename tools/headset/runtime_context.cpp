#include "tools/headset/runtime_context.h"

#include <algorithm>
#include <utility>

#include "base/trace_file.h"
#include "tools/headset/draw/eye_images.h"

namespace neuvv::headset {

RuntimeContext::RuntimeContext(Program& program)
    : runtime(program.options.views),
      device(
          program.options.device, program.options.validate ? gpu::Validation::kOn : gpu::Validation::kOff,
          [this, &program] {
              gpu::DeviceExtensions extensions = runtime.device_extensions();
              if (!program.window) return extensions;
              const gpu::DeviceExtensions more = program.window->extensions();
              extensions.instance.insert(extensions.instance.end(), more.instance.begin(), more.instance.end());
              extensions.device.insert(extensions.device.end(), more.device.begin(), more.device.end());
              return extensions;
          }(),
          runtime.device_maker()),
      overlaps(images_overlap(device)),
      painter(program.interaction.painter) {
    painter.project_image = [this](const std::filesystem::path& file, editor::PaintSubject subject,
                                   editor::Layer before, const editor::PaintOperation& operation,
                                   editor::PaintArea area) -> std::optional<editor::PaintSession> {
        if (!renderer) return std::nullopt;
        subject.field = renderer->find_field(file, subject.clip->field);
        if (subject.field.expired()) return std::nullopt;
        editor::PaintSession session(std::move(subject), std::move(before), operation, std::move(area));
        editor::PaintSurface surface(device);
        while (session.add_projection(surface)) {
        }
        return session;
    };
}

namespace {

void update_clips(HeadsetState& state, RuntimeContext& context) {
    state.leaf_boxes.clear();
    for (uint32_t clip = 0; clip < state.stage->clips.size(); ++clip) {
        state.leaf_boxes.push_back(context.renderer->leaf_box(clip));
        context.clips[state.stage->clips[clip].path] = context.renderer->shared_field(clip);
    }
}

}  // namespace

// The clip of a new performer is read by a thread; what was read is kept until the performer is on the stage.
void RuntimeContext::read_new_clip(HeadsetState& state) {
    std::optional<NewPerformer>& performer = state.new_performer;
    const bool reads = preload && !preload->is_done();
    if (reads || (performer && performer->is_shown)) return;
    if (!performer || (preload && preload->clips()[0] != performer->clip)) preload.reset();
    if (!performer || performer->is_read) return;
    if (!preload && !clips.contains(performer->clip)) {
        preload =
            std::make_unique<render::ClipPreload>(loader->files(), std::vector{performer->clip}, nullptr, nullptr);
        return;
    }
    try {
        if (preload) preload->expect_read();
        performer->is_read = true;
    } catch (const InputError& error) {
        state.editor.notify(error.what(), true);
        performer.reset();
        preload.reset();
    }
}

void RuntimeContext::read_next_document(HeadsetState& state) {
    std::optional<NextDocument>& next = state.next_document;
    if (!next) next_clips.reset();  // it has been opened, or cannot be
    if (!next || !next->document || next->is_read) return;
    if (!next_clips) {
        std::vector<std::filesystem::path> of_stage = edit::clips_of(next->document->file);
        next->clips = of_stage.size();
        next_clips_read = 0;
        next_clips = std::make_unique<render::ClipPreload>(
            loader->files(), std::move(of_stage), [this](size_t read) { next_clips_read = read; }, nullptr);
    }
    next->clips_read = next_clips_read;
    if (!next_clips->is_done()) return;
    try {
        next_clips->expect_read();
        next->is_read = true;
    } catch (const InputError& error) {
        state.editor.notify(error.what(), true);
        next.reset();
    }
}

void RuntimeContext::follow(Program& program) {
    read_new_clip(program.state);
    read_next_document(program.state);
    if (program.open_next()) clips.clear();
    program.state.follow_document();
    if (drawn_stage == program.state.stage) return;
    const TraceSpan span("follow an edit");
    try {
        renderer->change(*program.state.stage, render::with_memory_of_slices(renderer->frames(), [&] {
            return loader->load(*program.state.stage);
        }));
    } catch (const InputError& error) {  // a clip or a layer is missing: the last edit cannot be shown
        program.state.stage = drawn_stage;
        return program.state.editor.take_back(error.what());
    }
    drawn_stage = program.state.stage;
    update_clips(program.state, *this);
}

void RuntimeContext::make_renderer(Program& program, const EyeImages& eyes) {
    if (renderer) return;
    const render::PaintSource paint = [&program](const std::filesystem::path& layer) {
        return voctree::files_of_layer(program.state.editor.document().paint, stage::absolute_path(layer));
    };
    drawn_stage = program.state.stage;
    loader = std::make_unique<render::StageLoader>(device, paint, render::SolidParts::kYes);
    renderer =
        std::make_unique<render::StageRenderer>(device, *drawn_stage, loader->load(*drawn_stage), eyes.capacity());
    update_clips(program.state, *this);
    program.state.evaluate();
    update_solid(program.state);
    if (!program.start)
        program.state.floor_m = editor::floor_of(program.state);  // afterwards it stays, as the user stands on it
}

void RuntimeContext::update_solid(HeadsetState& state) const {
    state.solid.resize(state.stage->performers.size());
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        const auto solid = renderer->solid_of(performer);
        editor::SolidPart& part = state.solid[performer.performer];
        if (!solid)
            part = {};
        else if (part.leaves != solid->leaves || part.frame != solid->frame)
            part = {solid->leaves, solid->frame};  // forgets the box
    }
}

namespace {

// Whether each ray may be of the same hand as before, which has moved for one frame.
bool are_near(std::span<const Ray> before, std::span<const Ray> now) {
    constexpr double kNear_m = 0.1;
    return std::ranges::equal(before, now,
                              [](const Ray& a, const Ray& b) { return glm::distance(a.origin, b.origin) < kNear_m; });
}

bool is_shown(const stage::EvaluatedStage& evaluated, uint32_t performer) {
    return std::ranges::any_of(evaluated.performers, [&](const stage::EvaluatedPerformer& one) {
        return one.performer == performer && one.visible && one.opacity > 0;
    });
}

}  // namespace

std::vector<std::optional<SurfaceHit>> RuntimeContext::find_surfaces(const stage::EvaluatedStage& evaluated,
                                                                     std::span<const Ray> rays) {
    const auto begin = [&] {
        render::with_memory_of_slices(renderer->frames(), [&] {
            picks.begin(*renderer, evaluated, rays);
            return true;
        });
    };
    const bool same_stage = std::exchange(picked_stage, drawn_stage) == drawn_stage;
    if (!overlaps || !same_stage || !are_near(picked_rays, rays)) begin();
    const auto picked = picks.take(*renderer);
    if (overlaps) begin();  // for the next call
    picked_rays.assign(rays.begin(), rays.end());
    std::vector<std::optional<SurfaceHit>> hits(rays.size());
    for (size_t i = 0; i < picked.size(); ++i)
        if (picked[i] && is_shown(evaluated, picked[i]->performer))
            hits[i] = SurfaceHit{picked[i]->performer, picked[i]->distance_m, picked[i]->colour};
    return hits;
}

void ValidationPrinter::print() const {
    for (const std::string& message : device.drain_validation_messages()) print_line("validation: " + message);
}

}  // namespace neuvv::headset
