#include "render/clips/stage_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/trace_file.h"
#include "gpu/host_copies.h"
#include "voctree/files/half.h"

namespace neuvv::render {

namespace {

SetLightKind kind_of(stage::GltfLightKind kind) {
    switch (kind) {
        case stage::GltfLightKind::kDirectional:
            return SetLightKind::kDirectional;
        case stage::GltfLightKind::kPoint:
            return SetLightKind::kPoint;
        case stage::GltfLightKind::kSpot:
            return SetLightKind::kSpot;
    }
    return SetLightKind::kPoint;
}

// One of two places between which a performer fades, as if it were the only one.
StageClips::Place alone(StageClips::Place place) {
    place.share = 1;
    return place;
}

std::vector<glm::vec4> download_halves(const gpu::Device& device, const gpu::Buffer& from) {
    std::vector<uint16_t> halves(from.bytes / 2);
    gpu::download(device, from, halves.data(), from.bytes);
    std::vector<glm::vec4> colours(halves.size() / 4);
    for (size_t i = 0; i < halves.size(); ++i)
        colours[i / 4][static_cast<int>(i % 4)] = voctree::float_from_half(halves[i]);
    return colours;
}

// A light from above that a white surface facing it returns as `returned`.
SetLight room_lamp(const glm::dvec3& returned) {
    SetLight lamp;
    lamp.kind = SetLightKind::kDirectional;
    lamp.direction = glm::normalize(glm::dvec3(0.1, -1, -0.1));
    lamp.colour = returned * std::numbers::pi;
    lamp.casts_shadow = true;
    return lamp;
}

}  // namespace

SetLight set_light(const stage::EvaluatedLight& light) {
    SetLight out;
    out.kind = kind_of(light.kind);
    out.position = light.position;
    out.direction = light.direction;
    out.colour = light.intensity;
    out.range_m = light.range_m;
    out.inner_cos = light.cos_inner;
    out.outer_cos = light.cos_outer;
    out.casts_shadow = out.kind != SetLightKind::kPoint;
    return out;
}

StageRenderer::StageRenderer(const gpu::Device& device, const stage::Stage& stage, const StageAssets& assets,
                             const FrameCapacity& capacity)
    : device_(device), stage_(&stage), lack_budget_(capacity.slice_budget), capacity_(capacity), clips_(assets) {
    set_ = std::make_unique<SetRaster>(device, stage.scene, capacity.samples * capacity.width,
                                       capacity.samples * capacity.height, capacity.views, assets.environment);
    fields_ = clips_.fields();
    frames_ = std::make_unique<FrameRenderer>(device, fields_, capacity, set_.get());
    slice_shares_ = clips_.usual_fields();
    update_fields();
    apply_paints(stage, make_paints(stage, assets));
}

void StageRenderer::change(const stage::Stage& stage, const StageAssets& assets) {
    frames_->finish();
    NextPaints paints = with_memory_of_slices(*frames_, [&] {
        NextPaints made = make_paints(stage, assets);
        set_->change(stage.scene, assets.environment);
        return made;
    });
    // Nothing may fail from here on.
    StageClips next(assets);
    next.go_on_from(clips_);
    const StageClips before = std::exchange(clips_, std::move(next));
    slice_shares_ = clips_.usual_fields();
    reported_problems_ = 0;
    update_fields();
    stage_ = &stage;
    apply_paints(stage, std::move(paints));
}

// Gives the frame renderer the fields of the clips. While a stage plays, the slice budget is divided into more shares
// where there are more fields, but never into fewer, because slices of another size must be built again.
void StageRenderer::update_fields() {
    fields_ = clips_.fields();
    const auto sliced = std::ranges::count_if(fields_, [](const Field* field) { return !field->slice; });
    while (slice_shares_ < sliced) slice_shares_ = std::max(2 * slice_shares_, 1u);
    frames_->change_fields(fields_, slice_shares_);
    clips_.free_dropped();
    update_segment_paints();
}

// Numbers the paints of segments that are there now, and removes those of before.
void StageRenderer::update_segment_paints() {
    auto before = std::exchange(segment_paints_, {});
    clips_.for_segments([&](const ClipOnDevice::Segment& segment) {
        for (const auto& one : segment.paints) {
            if (!one->paint || segment_paints_.contains(one->paint)) continue;
            const auto known = before.extract(one->paint);
            segment_paints_[one->paint] =
                known
                    ? known.mapped()
                    : NumberedPaint{segment.loaded, frames_->paints(number_of(segment.loaded->field)).add(one->paint)};
        }
    });
    if (!before.empty()) frames_->finish();
    for (const auto& [paint, numbered] : before) {
        const auto clip = numbered.clip.lock();
        const uint32_t field = clip ? number_of(clip->field) : static_cast<uint32_t>(fields_.size());
        if (field < fields_.size()) frames_->paints(field).remove(numbered.number);
    }
}

std::vector<Note> StageRenderer::take_problems() {
    const std::vector<Note>& all = clips_.problems();
    const size_t reported = std::exchange(reported_problems_, all.size());
    return {all.begin() + static_cast<ptrdiff_t>(reported), all.end()};
}

std::vector<std::pair<const Field*, float>> StageRenderer::shown(const stage::EvaluatedStage& evaluated) const {
    std::vector<std::pair<const Field*, float>> shown;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (!performer.visible) continue;
        for (const StageClips::Place& place : clips_.places_of(performer)) shown.emplace_back(place.field, place.frame);
    }
    return shown;
}

std::vector<Instance> StageRenderer::instances_at(std::span<const double> times_s) const {
    std::vector<Instance> instances;
    for (const double time_s : times_s)
        for (const Instance& instance : settings_at(stage::stage_at(*stage_, time_s)).instances)
            instances.push_back(instance);
    return instances;
}

bool StageRenderer::awaits(const std::filesystem::path& file) const {
    for (const ClipOnDevice& clip : clips_.clips())
        for (size_t i = 0; i < clip.segments.size(); ++i)
            if (clip.index.segments[i].file == file && clip.segments[i].readable && !clip.segments[i].loaded)
                return true;
    return false;
}

std::shared_ptr<const Field> StageRenderer::find_field(const std::filesystem::path& file,
                                                       const voctree::PaintedField& painted) const {
    for (const ClipOnDevice& clip : clips_.clips())
        for (const ClipOnDevice::Segment& segment : clip.segments)
            if (segment.loaded && segment.loaded->path == file && segment.loaded->painted == painted)
                return {segment.loaded, &segment.loaded->field};
    return nullptr;
}

StageRenderer::NextPaints StageRenderer::make_paints(const stage::Stage& stage, const StageAssets& assets) const {
    NextPaints next;
    for (size_t i = 0; i < stage.performers.size(); ++i) {
        PaintKey& key = next.of_performer.emplace_back();
        if (assets.paint[i].empty()) continue;
        key = {assets.clips[stage.performers[i].clip].first, assets.paint[i]};
        if (paint_numbers_.contains(key) || next.new_paints.contains(key)) continue;
        std::vector<PaintUse> uses;
        for (const LoadedLayer& layer : key.layers) uses.push_back({layer.edits.get(), layer.blend, layer.opacity});
        next.new_paints.try_emplace(key, device_, key.clip->field.leaf_count, uses);
    }
    return next;
}

uint32_t StageRenderer::number_of(const Field& field) const {
    return static_cast<uint32_t>(std::find(fields_.begin(), fields_.end(), &field) - fields_.begin());
}

// Adds the new paints and removes unused ones. The renderer must have the fields of this stage already.
void StageRenderer::apply_paints(const stage::Stage& stage, NextPaints next) {
    std::map<PaintKey, uint32_t> numbers;
    paints_.clear();
    for (size_t i = 0; i < stage.performers.size(); ++i) {
        const PaintKey& key = next.of_performer[i];
        if (key.layers.empty()) {
            paints_.push_back(0);
            continue;
        }
        const auto [number, is_new] = numbers.try_emplace(key, 0);
        if (is_new) {
            const auto kept = paint_numbers_.find(key);
            number->second = kept != paint_numbers_.end()
                                 ? kept->second
                                 : frames_->paints(number_of(key.clip->field)).add(std::move(next.new_paints.at(key)));
        }
        paints_.push_back(number->second);
    }
    for (const auto& [key, number] : paint_numbers_) {
        const uint32_t field = number_of(key.clip->field);
        if (field < fields_.size() && !numbers.contains(key)) frames_->paints(field).remove(number);
    }
    paint_numbers_ = std::move(numbers);
}

void StageRenderer::resize(uint32_t width, uint32_t height) {
    const uint32_t has_width = set_->targets().width / capacity_.samples,
                   has_height = set_->targets().height / capacity_.samples;
    if (width > has_width || height > has_height) {
        try {
            with_memory_of_slices(*frames_,
                                  [&] { make_targets(std::max(width, has_width), std::max(height, has_height)); });
        } catch (const RuntimeFailure&) {
            make_targets(has_width, has_height);
            throw;
        }
    }
    capacity_.width = width;
    capacity_.height = height;
}

void StageRenderer::make_targets(uint32_t width, uint32_t height) {
    FrameCapacity capacity = capacity_;
    capacity.width = width;
    capacity.height = height;
    frames_->finish();
    set_->resize(capacity.samples * width, capacity.samples * height);
    frames_ = std::make_unique<FrameRenderer>(std::move(*frames_), capacity);
}

void StageRenderer::bring_to_device(const stage::EvaluatedStage& evaluated, MissingSegments missing) {
    clips_.follow(*stage_, evaluated, missing);
    update_fields();
    if (const Note problem = clips_.take_lack_of_memory(); !problem.empty()) {
        // Where slices have gone since the last time, or there are some to drop, the thread tries again.
        const bool have_gone = frames_->slices().budget() < lack_budget_;
        if (!have_gone && (frames_->slices().budget() <= 1 || !frames_->drop_slices()))
            clips_.tell_lack_of_memory(problem);
        lack_budget_ = frames_->slices().budget();
    }
    if (missing == MissingSegments::kWait) {
        try {
            clips_.read_missing(evaluated);
        } catch (const RuntimeFailure&) {
            update_fields();  // of those that were read
            throw;
        }
        update_fields();
    }
}

void StageRenderer::show(const stage::EvaluatedStage& evaluated, bool show_environment, MissingSegments missing) {
    const TraceSpan span("show the stage");
    with_memory_of_slices(*frames_, [&] { bring_to_device(evaluated, missing); });
    std::vector<SetLight> lights;
    for (const stage::EvaluatedLight& light : evaluated.lights) lights.push_back(set_light(light));
    SetAmbient ambient;
    ambient.light = stage_->ambient;
    if (stage_->settings.environment) {
        ambient.environment_intensity = stage_->settings.environment->intensity;
        ambient.environment_rotation = glm::radians(stage_->settings.environment->rotation_deg);
        ambient.show_environment = show_environment;
    }
    if (!set_->has_pose(evaluated.pose)) frames_->finish();
    set_->pose(evaluated.pose);
    has_room_lamp_ = room_floor_m_ && lights.empty();
    if (has_room_lamp_) {
        ambient.light *= 0.5;
        lights.push_back(room_lamp(ambient.light));
    }
    const bool shadows = stage_->settings.shadows;
    set_->lighting.light(lights, ambient, {shadows && !room_floor_m_, shadows});
}

SetRays StageRenderer::set_rays() const {
    SetRays set{download_halves(device_, set_->targets().colour), download_halves(device_, set_->targets().front), {}};
    set.axis_m.resize(set.behind.size());
    gpu::download(device_, set_->targets().depth, set.axis_m.data(), set.axis_m.size() * sizeof(float));
    return set;
}

// Composites as with_set of show.glsl does.
media::LinearImage StageRenderer::linear_image_of(const stage::Camera& camera, const SetRays& set,
                                                  const glm::vec4& background) const {
    std::vector<glm::vec4> light = frames_->radiance();
    std::vector<float> metres = frames_->depth();
    const stage::Camera rays = stage::enlarged(camera, capacity_.samples);
    for (size_t i = 0; i < light.size(); ++i) {
        const float alpha = light[i].a, through = std::isinf(set.axis_m[i]) ? 0.0f : 1 - alpha;
        const float set_metres = set.axis_m[i] / axis_per_ray(rays, {i % rays.width, i / rays.width});
        if (through > 0)
            metres[i] = ((alpha > 0 ? alpha * metres[i] : 0.0f) + through * set_metres) / (alpha + through);
        light[i] += (1 - alpha) * set.behind[i];
        light[i] = set.front[i] + (1 - set.front[i].a) * light[i];
    }
    return linear_image(light, metres, camera, capacity_.samples, background);
}

Instance StageRenderer::instance_at(const stage::EvaluatedPerformer& performer, const StageClips::Place& place) const {
    const bool has_segment_paint = place.paint && place.paint->paint;
    return Instance{place.frame,
                    glm::mat4(performer.world_from_performer),
                    has_segment_paint ? segment_paints_.at(place.paint->paint).number : paints_[performer.performer],
                    number_of(*place.field),
                    performer.opacity,
                    place.share,
                    performer.casts_shadow,
                    performer.receives_shadow && !has_room_lamp_,
                    nullptr,
                    performer.performer};
}

std::optional<Instance> StageRenderer::instance_of(const stage::EvaluatedPerformer& performer) const {
    if (!performer.visible) return std::nullopt;
    const std::vector<StageClips::Place> places = clips_.places_of(performer);
    if (places.empty()) return std::nullopt;
    return instance_at(performer, alone(places[0]));
}

std::optional<StageRenderer::SolidAt> StageRenderer::solid_of(const stage::EvaluatedPerformer& performer) const {
    const std::vector<StageClips::Place> places = clips_.places_of(performer);
    if (places.empty()) return std::nullopt;
    return SolidAt{places[0].solid, double{places[0].frame}};
}

FrameSettings StageRenderer::settings_at(const stage::EvaluatedStage& evaluated,
                                         const PerformerHighlight& highlight) const {
    FrameSettings settings;
    settings.width = capacity_.width;
    settings.height = capacity_.height;
    settings.samples = capacity_.samples;
    settings.mode = TraceMode::kPlay;
    settings.blend = stage_->settings.blend == stage::StageBlend::kExact ? Blend::kExact : Blend::kPaper;
    settings.lit = stage_->settings.falloff;
    settings.resolve.background = glm::vec4(stage_->settings.background, 1);
    settings.instances.clear();
    // Layers would hide one of two segments behind the other.
    const bool may_fade = settings.blend == Blend::kExact && 2 * evaluated.performers.size() <= kMaxInstances;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (!performer.visible) continue;
        std::vector<StageClips::Place> places = clips_.places_of(performer);
        // Two translucent instances, one in the other, let less light through than one.
        const bool fades = may_fade && performer.opacity >= 1;
        if (places.size() > 1 && !fades) places = {alone(places[0])};
        for (const StageClips::Place& place : places) {
            Instance& instance = settings.instances.emplace_back(instance_at(performer, place));
            if (performer.performer == highlight.performer) instance.highlight = highlight.highlight;
        }
    }
    if (settings.instances.size() > kMaxInstances)
        throw InputError(stage_->file.path.string(), "",
                         fmt::format("shows {} performers at {:.6g} s, an image {} at most", settings.instances.size(),
                                     evaluated.time_s, kMaxInstances),
                         "hide or remove some of them");
    return settings;
}

}  // namespace neuvv::render
