// A stage that is edited, and a renderer that follows the edits.
#pragma once

#include <gtest/gtest.h>

#include "base/error.h"
#include "gpu/host_copies.h"
#include "render/clips/stage_renderer.h"
#include "support/figure.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/set_scene.h"
#include "voctree/files/nvv.h"

namespace neuvv::test::stage_renderer_test {

using StageRendererTest = GpuTest;

constexpr uint32_t kWidth = 62, kHeight = 44;

inline voctree::VOctree clip_tree(uint64_t seed) {
    return random_tree({.seed = seed, .node_levels = 3, .leaves = 1500});
}

// The document of a stage to be edited: a floor with a texture, a box that casts a shadow, a pane of glass, a lamp and
// two performers.
struct Draft {
    TemporaryFolder folder;
    GlbBuilder glb;
    json& root = glb.root;

    Draft() {
        voctree::write_nvv(folder.path / "a.nvv", clip_tree(1));
        json chequered = pbr_material({1, 1, 1, 1}, 0, 1);
        chequered["pbrMetallicRoughness"]["baseColorTexture"] = {
            {"index", test::add_texture(glb, one_colour(200, 120, 40))}};
        add_mesh(glb, rectangle({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}), chequered);
        add_mesh(glb, sphere({1.2, 0.4, 0.6}, 0.3f, 8), pbr_material({0.3f, 0.4f, 0.9f, 1}, 0, 0.4));
        json glass = pbr_material({0.2f, 0.9f, 0.3f, 0.4f}, 0, 0.5);
        glass["alphaMode"] = "BLEND";
        add_mesh(glb, rectangle({-0.2f, 0.2f, 0.9f}, {0.8f, 0, 0}, {0, 0.7f, 0}), glass);
        root["extensionsUsed"] = {"KHR_lights_punctual", "NEUVV_performer", "NEUVV_stage"};
        root["extensions"]["KHR_lights_punctual"]["lights"] = {
            {{"type", "spot"}, {"intensity", 90}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.7}}}}};
        root["nodes"].push_back({{"name", "lamp"},
                                 {"translation", {0.4, 4, 1}},
                                 {"rotation", {-0.7071067811865476, 0, 0, 0.7071067811865476}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        add_performer("anna", "a.nvv", {-0.9, 0, 0});
        add_performer("bert", "a.nvv", {0.4, 0.1, -0.6});
        settings() = {{"ambient", {0.2, 0.2, 0.25}}};
    }
    json& settings() { return root["scenes"][0]["extensions"]["NEUVV_stage"]; }
    json& node(const std::string& name) {
        for (json& one : root["nodes"])
            if (one.value("name", "") == name) return one;
        throw std::runtime_error("no node " + name);
    }
    json& performer(const std::string& name) { return node(name)["extensions"]["NEUVV_performer"]; }
    void add_performer(const std::string& name, const std::string& clip, glm::dvec3 at) {
        root["nodes"].push_back({{"name", name},
                                 {"translation", {at.x, at.y, at.z}},
                                 {"extensions", {{"NEUVV_performer", {{"uri", clip}}}}}});
    }
    void remove_node(const std::string& name) {
        json& nodes = root["nodes"];
        for (size_t i = 0; i < nodes.size(); ++i)
            if (nodes[i].value("name", "") == name) {
                nodes.erase(i);
                return;
            }
        throw std::runtime_error("no node " + name);
    }
    std::unique_ptr<stage::Stage> stage() {
        root["scene"] = 0;
        root["scenes"][0]["nodes"] = json::array();
        for (size_t i = 0; i < root["nodes"].size(); ++i) root["scenes"][0]["nodes"].push_back(i);
        return std::make_unique<stage::Stage>(stage::load_stage(folder.write(glb.bytes(), "stage.glb")));
    }
};

inline stage::Camera camera_of_size(uint32_t width, uint32_t height) {
    return look_at({0.4, 1.6, 4.2}, {0.2, 0.5, 0}, width, height, 1.1);
}

inline media::Image drawn(render::StageRenderer& renderer, const stage::Stage& stage) {
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0.06);
    renderer.show(evaluated);
    const render::FrameSettings settings = renderer.settings_at(evaluated);
    return renderer.frames().render(camera_of_size(settings.width, settings.height), settings);
}

// A renderer that follows the edits of a draft.
struct Live {
    const gpu::Device& device;
    Draft& draft;
    std::unique_ptr<stage::Stage> stage = draft.stage();
    render::PaintSource source;
    render::StageLoader loader{device, source};
    render::StageRenderer renderer{device, *stage, loader.load(*stage), {kWidth, kHeight}};

    media::Image image() { return drawn(renderer, *stage); }
    media::Image fresh_image() const {
        render::StageRenderer fresh(device, *stage, render::StageLoader(device, source).load(*stage),
                                    {kWidth, kHeight});
        return drawn(fresh, *stage);
    }
    void change() {
        std::unique_ptr<stage::Stage> next = draft.stage();
        renderer.change(*next, loader.load(*next));
        stage = std::move(next);
    }
    // The image changes, and is that of a new renderer.
    void expect_change(const std::string& what) {
        SCOPED_TRACE(what);
        const media::Image before = image();
        change();
        const media::Image after = image();
        EXPECT_NE(after.rgba, before.rgba);
        EXPECT_EQ(after.rgba, fresh_image().rgba);
    }
};

}  // namespace neuvv::test::stage_renderer_test
