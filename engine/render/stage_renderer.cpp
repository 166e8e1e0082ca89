#include "render/stage_renderer.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "voctree/half.h"
#include "voctree/nvpaint.h"
#include "voctree/nvv.h"

namespace neuvv {

namespace {

SetLightKind kind_of(GltfLightKind kind) {
    switch (kind) {
        case GltfLightKind::kDirectional:
            return SetLightKind::kDirectional;
        case GltfLightKind::kPoint:
            return SetLightKind::kPoint;
        case GltfLightKind::kSpot:
            return SetLightKind::kSpot;
    }
    return SetLightKind::kPoint;
}

std::vector<glm::vec4> download_halves(const Device& device, const Buffer& from) {
    std::vector<uint16_t> halves(from.bytes / 2);
    download(device, from, halves.data(), from.bytes);
    std::vector<glm::vec4> colours(halves.size() / 4);
    for (size_t i = 0; i < halves.size(); i++) colours[i / 4][static_cast<int>(i % 4)] = float_from_half(halves[i]);
    return colours;
}

}  // namespace

SetLight set_light(const InstantLight& light) {
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

StageRenderer::StageRenderer(const Device& device, const Stage& stage, const FrameCapacity& capacity,
                             const std::function<void(size_t, size_t)>& loaded)
    : device_(device), stage_(stage), capacity_(capacity) {
    fields_.reserve(stage.clips.size());  // renderers keep their addresses
    for (const StageClip& clip : stage.clips) {
        const VOctree tree = read_nvv(clip.path);
        fields_.push_back(upload_field(device, tree, WeightPrecision::kHalf));
        painted_.push_back(painted_field(tree));
        if (loaded) loaded(fields_.size(), stage.clips.size());
    }
    std::optional<Image> environment;
    if (stage.settings.environment)
        environment = read_png(file_of_uri(stage.file, stage.settings.environment->uri, "/environment/uri"));
    set_ = std::make_unique<SetRaster>(device, stage.scene, capacity.samples * capacity.width,
                                       capacity.samples * capacity.height, capacity.views,
                                       environment ? &*environment : nullptr);
    std::vector<const Field*> fields;
    for (const Field& field : fields_) fields.push_back(&field);
    frames_ = std::make_unique<FrameRenderer>(device, std::move(fields), capacity, set_.get());
    for (const StagePerformer& performer : stage.performers) paints_.push_back(add_paint(performer));
}

// The layers of a performer that show, as a paint of its clip; 0: none do.
uint32_t StageRenderer::add_paint(const StagePerformer& performer) {
    std::string all = fmt::format("{}", performer.clip);
    for (const PaintLayer& layer : performer.settings.paint)
        if (layer.visible && layer.opacity > 0)
            all += fmt::format("\n{}\n{}\n{}", layer.uri, static_cast<int>(layer.blend), layer.opacity);
    if (const auto known = paint_of_layers_.find(all); known != paint_of_layers_.end()) return known->second;
    std::vector<EditLayer> layers;
    std::vector<PaintUse> uses;
    for (size_t i = 0; i < performer.settings.paint.size(); i++) {
        const PaintLayer& layer = performer.settings.paint[i];
        if (!layer.visible || layer.opacity <= 0) continue;
        const std::string place = fmt::format("\"{}\": paint layer {}", performer.name, i);
        try {
            layers.push_back(read_paint(file_of_uri(stage_.file, layer.uri, place), painted_[performer.clip]));
        } catch (const InputError& problem) {
            throw InputError(stage_.file.path.string(), place, problem.what());
        }
        uses.push_back({nullptr, layer.blend, static_cast<float>(layer.opacity)});
    }
    for (size_t i = 0; i < layers.size(); i++) uses[i].layer = &layers[i];
    return paint_of_layers_[all] = uses.empty() ? 0 : frames_->paints(performer.clip).add(uses);
}

void StageRenderer::show(const StageInstant& instant, bool show_environment) {
    std::vector<SetLight> lights;
    for (const InstantLight& light : instant.lights) lights.push_back(set_light(light));
    SetAmbient ambient;
    ambient.light = stage_.ambient;
    if (stage_.settings.environment) {
        ambient.environment_intensity = stage_.settings.environment->intensity;
        ambient.environment_rotation = glm::radians(stage_.settings.environment->rotation_deg);
        ambient.show_environment = show_environment;
    }
    set_->pose(instant.pose);
    set_->light(lights, ambient, {stage_.settings.shadows, stage_.settings.shadows});
}

// As show.glsl's with_set.
LinearImage StageRenderer::linear_picture_of(const Camera& camera, const glm::vec4& background) const {
    std::vector<glm::vec4> light = frames_->radiance();
    std::vector<float> metres = frames_->depth();
    const std::vector<glm::vec4> behind = download_halves(device_, set_->colour);
    const std::vector<glm::vec4> front = download_halves(device_, set_->front);
    std::vector<float> axis_metres(behind.size());
    download(device_, set_->depth, axis_metres.data(), axis_metres.size() * sizeof(float));
    const Camera texels = enlarged(camera, capacity_.samples);
    for (size_t i = 0; i < light.size(); i++) {
        const glm::dvec2 at(static_cast<double>(i % texels.width) + 0.5, static_cast<double>(i / texels.width) + 0.5);
        const glm::dvec2 line = (at - glm::dvec2(texels.cx, texels.cy)) / glm::dvec2(texels.fx, texels.fy);
        const float alpha = light[i].a, through = std::isinf(axis_metres[i]) ? 0.0f : 1 - alpha;
        const float set_metres = axis_metres[i] * static_cast<float>(glm::length(glm::dvec3(line, 1)));
        if (through > 0)
            metres[i] = ((alpha > 0 ? alpha * metres[i] : 0.0f) + through * set_metres) / (alpha + through);
        light[i] += (1 - alpha) * behind[i];
        light[i] = front[i] + (1 - front[i].a) * light[i];
    }
    return linear_picture(light, metres, capacity_.width, capacity_.height, capacity_.samples, background);
}

FrameSettings StageRenderer::settings_at(const StageInstant& instant) const {
    FrameSettings settings;
    settings.width = capacity_.width;
    settings.height = capacity_.height;
    settings.samples = capacity_.samples;
    settings.mode = TraceMode::kPlay;
    settings.blend = stage_.settings.blend == StageBlend::kExact ? Blend::kExact : Blend::kPaper;
    settings.lit = stage_.settings.falloff;
    settings.resolve.background = glm::vec4(stage_.settings.background, 1);
    settings.instances.clear();
    for (const InstantPerformer& performer : instant.performers) {
        if (!performer.visible) continue;
        settings.instances.push_back({performer.frame, glm::mat4(performer.world_from_performer),
                                      paints_[performer.performer], performer.clip, performer.opacity,
                                      performer.casts_shadow, performer.receives_shadow});
    }
    return settings;
}

}  // namespace neuvv
