#include "render/stage_renderer.h"

#include <glm/gtc/constants.hpp>

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
    : stage_(stage), capacity_(capacity) {
    fields_.reserve(stage.clips.size());  // renderers keep their addresses
    for (const StageClip& clip : stage.clips) {
        fields_.push_back(upload_field(device, read_nvv(clip.path), WeightPrecision::kHalf));
        if (loaded) loaded(fields_.size(), stage.clips.size());
    }
    std::optional<Image> environment;
    if (stage.settings.environment) environment = read_png(file_of_uri(stage.file, stage.settings.environment->uri, "/environment/uri"));
    set_ = std::make_unique<SetRaster>(device, stage.scene, capacity.samples * capacity.width,
                                       capacity.samples * capacity.height, capacity.views,
                                       environment ? &*environment : nullptr);
    std::vector<const Field*> fields;
    for (const Field& field : fields_) fields.push_back(&field);
    frames_ = std::make_unique<FrameRenderer>(device, std::move(fields), capacity, set_.get());
}

void StageRenderer::show(const StageInstant& instant) {
    std::vector<SetLight> lights;
    for (const InstantLight& light : instant.lights) lights.push_back(set_light(light));
    SetAmbient ambient;
    ambient.light = stage_.ambient;
    if (stage_.settings.environment) {
        ambient.environment_intensity = stage_.settings.environment->intensity;
        ambient.environment_rotation = glm::radians(stage_.settings.environment->rotation_deg);
        ambient.show_environment = true;
    }
    set_->pose(instant.pose);
    set_->light(lights, ambient, {stage_.settings.shadows, stage_.settings.shadows});
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
        settings.instances.push_back({performer.frame, glm::mat4(performer.world_from_performer), performer.clip,
                                      performer.opacity, performer.casts_shadow, performer.receives_shadow});
    }
    return settings;
}

}  // namespace neuvv
