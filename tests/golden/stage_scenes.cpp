#include "golden/stage_scenes.h"

#include <functional>

#include "edit/operations.h"
#include "golden/foreign_stage.h"
#include "render/clips/stage_renderer.h"
#include "support/look_at.h"
#include "support/temporary_folder.h"
#include "support/waver_tree.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kWidth = 240, kHeight = 135, kSamples = 2;

// A stage under construction, and its clip on the disk.
struct Builder {
    TemporaryFolder folder;
    std::filesystem::path clip = folder.path / "figure.nvv";
    stage::StageFile file = edit::new_stage(folder.path / "stage.gltf");

    Builder() { voctree::write_nvv(clip, waver_tree()); }

    uint32_t add(const std::string& name, glm::dvec3 at, glm::dvec3 turn_deg = glm::dvec3(0),
                 edit::PerformerEdit edit = {}) {
        edit::Placement place;
        place.at = at;
        place.turn_deg = turn_deg;
        edit.clip = clip;
        if (!edit.time) edit.time = stage::parse_time_map("freeze:5f", "test", "");
        edit::add_performer(file, name, edit, place);
        return edit::find_node(file, name);
    }
    void light(const edit::LightEdit& edit, glm::dvec3 at, glm::dvec3 aim) {
        edit::set_light(file, edit::find_node(file, "key"), edit);
        edit::Placement place;
        place.at = at;
        place.aim = aim;
        edit::place_node(file, edit::find_node(file, "key"), place);
    }
    void ambient(double light) {
        edit::StageEdit edit;
        edit.ambient = glm::dvec3(light);
        edit::set_stage(file, edit);
    }
};

media::Image render(const gpu::Device& device, const Builder& builder, const stage::Camera& camera, double time_s = 0,
                    const std::function<void(stage::Stage&)>& change = {}) {
    stage::Stage stage = stage::make_stage(builder.file);
    if (change) change(stage);
    render::StageRenderer renderer(device, stage, render::StageLoader(device).load(stage),
                                   {camera.width, camera.height, kSamples});
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, time_s);
    renderer.show(evaluated);
    return renderer.frames().render(camera, renderer.settings_at(evaluated));
}

stage::Camera wide_camera() {
    return look_at({0, 1.9, 5}, {0, 0.8, 0}, kWidth, kHeight, 1.15);
}

// Performers in a row: rotated, stretched and sheared.
media::Image space(const gpu::Device& device) {
    Builder builder;
    builder.add("turned", {-1.6, 0, 0}, {0, 60, 20});
    edit::Placement stretched;
    stretched.scale = glm::dvec3(1.5, 0.6, 0.8);
    edit::place_node(builder.file, builder.add("stretched", {0, 0, 0}), stretched);
    edit::Placement sheared;
    sheared.matrix = glm::dmat4({1, 0, 0, 0}, {0.5, 1, 0, 0}, {0, 0, 1, 0}, {1.3, 0, 0, 1});
    edit::place_node(builder.file, builder.add("sheared", {0, 0, 0}), sheared);
    return render(device, builder, look_at({0, 2.1, 6.8}, {0, 0.75, 0}, kWidth, kHeight, 1.15));
}

// Images at twelve times half a second apart, side by side. The clip has eight frames at four a second.
media::Image film(const gpu::Device& device, const std::string& time, double spin = 0) {
    constexpr uint32_t kTimes = 12, kFilmWidth = 20, kFilmHeight = 40;
    Builder builder;
    edit::PerformerEdit edit;
    edit.time = stage::parse_time_map(time, "test", "");
    edit.spin_deg_per_s = spin;
    builder.add("figure", {0, 0, 0}, {}, edit);
    builder.ambient(1);
    stage::Stage stage = stage::make_stage(builder.file);
    render::StageRenderer renderer(device, stage, render::StageLoader(device).load(stage),
                                   {kFilmWidth, kFilmHeight, kSamples});
    const stage::Camera camera = look_at({0.15, 1.1, 4}, {0.15, 0.95, 0}, kFilmWidth, kFilmHeight, 3.8);
    media::Image strip(kTimes * kFilmWidth, kFilmHeight);
    for (uint32_t i = 0; i < kTimes; ++i) {
        const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0.25 * i);
        renderer.show(evaluated);
        const media::Image one = renderer.frames().render(camera, renderer.settings_at(evaluated));
        for (uint32_t y = 0; y < kFilmHeight; ++y)
            std::copy_n(one.at(0, y), size_t{4} * kFilmWidth, strip.at(i * kFilmWidth, y));
    }
    return strip;
}

media::Image ring(const gpu::Device& device) {
    Builder builder;
    edit::PerformerEdit edit;
    edit.time = stage::parse_time_map("loop", "test", "");
    const uint32_t node = builder.add("figure", {0, 0, 1.6}, {}, edit);
    edit::CopySettings copies;
    copies.count = 11;
    copies.pattern = edit::CopyPattern::kRing;
    copies.distance_m = 2.2;
    copies.stagger = {1, true};
    edit::duplicate_node(builder.file, node, copies);
    return render(device, builder, look_at({0, 4.6, 6.5}, {0, 0.3, -0.4}, kWidth, kHeight, 0.95));
}

// Two overlapping performers, one of which may be translucent.
media::Image blend(const gpu::Device& device, stage::StageBlend way, double opacity) {
    Builder builder;
    edit::PerformerEdit edit;
    edit.opacity = opacity;
    builder.add("one", {-0.15, 0, 0}, {0, 40, 0}, edit);
    builder.add("other", {0.15, 0, 0.05}, {0, -50, 12});
    builder.ambient(0.8);
    return render(device, builder, look_at({0, 1.3, 3.4}, {0, 0.9, 0}, kWidth, kHeight, 0.95), 0,
                  [way](stage::Stage& stage) { stage.settings.blend = way; });
}

edit::LightEdit spot(double candela) {
    edit::LightEdit light;
    light.intensity = candela;
    light.color = glm::dvec3(1, 0.85, 0.6);
    light.inner_cone_deg = 18;
    light.outer_cone_deg = 26;
    return light;
}

media::Image lights(const gpu::Device& device, bool shadows, bool falloff) {
    Builder builder;
    builder.add("one", {-0.7, 0, -0.3}, {0, 20, 0});
    builder.add("other", {0.6, 0, 0.4}, {0, -30, 0});
    builder.light(spot(70), {-1.8, 3.6, 2}, {0, 0.4, 0});
    builder.ambient(0.12);
    return render(device, builder, wide_camera(), 0, [&](stage::Stage& stage) {
        stage.settings.shadows = shadows;
        stage.settings.falloff = falloff;
    });
}

// Two lights of different colours: two shadows.
media::Image two_lights(const gpu::Device& device) {
    Builder builder;
    builder.add("figure", {0, 0, 0}, {0, 10, 0});
    edit::LightEdit red = spot(60), blue = spot(60);
    red.color = glm::dvec3(1, 0.2, 0.1);
    blue.color = glm::dvec3(0.1, 0.3, 1);
    blue.kind = "spot";
    builder.light(red, {-2.5, 3, 2}, {0, 0.5, 0});
    edit::Placement place;
    place.at = glm::dvec3(2.5, 3, 2);
    place.aim = glm::dvec3(0, 0.5, 0);
    edit::add_light(builder.file, "blue", blue, place);
    builder.ambient(0.1);
    return render(device, builder, wide_camera());
}

// A directional light, whose shadows are parallel.
media::Image sun(const gpu::Device& device) {
    Builder builder;
    builder.add("one", {-0.7, 0, -0.3}, {0, 20, 0});
    builder.add("other", {0.6, 0, 0.4}, {0, -30, 0});
    edit::remove_light(builder.file, edit::find_node(builder.file, "key"));
    edit::LightEdit light;
    light.kind = "directional";
    light.intensity = 2.5;
    edit::Placement place;
    place.at = glm::dvec3(3, 4, 2);
    place.aim = glm::dvec3(0);
    edit::add_light(builder.file, "sun", light, place);
    builder.ambient(0.2);
    return render(device, builder, wide_camera());
}

// The stage of another program through its camera, at the start and the end of the camera's path.
media::Image foreign(const gpu::Device& device) {
    const TemporaryFolder folder;
    voctree::write_nvv(folder.path / "figure.nvv", waver_tree());
    write_text(folder.path / "stage.gltf", kForeignScene);
    const stage::Stage stage = stage::load_stage(folder.path / "stage.gltf");
    render::StageRenderer renderer(device, stage, render::StageLoader(device).load(stage), {kWidth, kHeight, kSamples});
    media::Image both(2 * kWidth, kHeight);
    for (uint32_t i = 0; i < 2; ++i) {
        const stage::EvaluatedStage evaluated = stage::stage_at(stage, 2 * i);
        renderer.show(evaluated);
        const stage::Camera camera = stage::camera_of(stage, "Camera", evaluated, kWidth, kHeight);
        const media::Image one = renderer.frames().render(camera, renderer.settings_at(evaluated));
        for (uint32_t y = 0; y < kHeight; ++y) std::copy_n(one.at(0, y), size_t{4} * kWidth, both.at(i * kWidth, y));
    }
    return both;
}

}  // namespace

std::vector<GoldenStage> golden_stages(const gpu::Device& device, const std::string& only) {
    std::vector<GoldenStage> stages;
    const auto add = [&](const std::string& name, const std::function<media::Image()>& draw) {
        if (only.empty() || only == name) stages.push_back({name, draw()});
    };
    add("stage_space", [&] { return space(device); });
    for (const auto& [name, time] : std::vector<std::pair<std::string, std::string>>{{"plain", ""},
                                                                                     {"offset", "offset:3f"},
                                                                                     {"speed", "speed:0.5"},
                                                                                     {"pause", "pause:3f:4f"},
                                                                                     {"freeze", "freeze:6f"},
                                                                                     {"clip", "clip:3f:6f"},
                                                                                     {"reverse", "reverse"},
                                                                                     {"jump", "jump:2f:5f"},
                                                                                     {"loop", "loop:2f:5f"},
                                                                                     {"ping_pong", "ping-pong"},
                                                                                     {"hold", "speed:0.5,hold"}})
        add("stage_time_" + name, [&device, time = time] { return film(device, time); });
    add("stage_spin", [&] { return film(device, "freeze:5f", 120); });
    add("stage_ring", [&] { return ring(device); });
    add("stage_blend_exact", [&] { return blend(device, stage::StageBlend::kExact, 1); });
    add("stage_blend_paper", [&] { return blend(device, stage::StageBlend::kPaper, 1); });
    add("stage_translucent", [&] { return blend(device, stage::StageBlend::kExact, 0.5); });
    add("stage_light", [&] { return lights(device, true, true); });
    add("stage_light_no_shadows", [&] { return lights(device, false, true); });
    add("stage_light_no_falloff", [&] { return lights(device, true, false); });
    add("stage_two_lights", [&] { return two_lights(device); });
    add("stage_sun", [&] { return sun(device); });
    add("stage_foreign", [&] { return foreign(device); });
    return stages;
}

}  // namespace neuvv::test
