// A renderer whose stage is edited draws the same as a new renderer of the edited stage.
#include <gtest/gtest.h>

#include "base/error.h"
#include "gpu/host_copies.h"
#include "render/clips/stage_renderer.h"
#include "render/stage_draft.h"
#include "support/figure.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/set_scene.h"
#include "voctree/files/nvpaint.h"
#include "voctree/files/nvv.h"

namespace neuvv::test::stage_renderer_test {
namespace {

TEST_F(StageRendererTest, PerformersAndLightsChangeWithoutUploads) {
    Draft draft;
    Live live{device(), draft};
    const render::Field* field = &live.renderer.field(0);
    const render::Performer* performer = nullptr;
    live.image();
    performer = live.renderer.frames().slices().performer();
    const uint64_t bytes = device().buffer_bytes();
    draft.node("anna")["translation"] = {-0.6, 0.2, 0.1};
    live.expect_change("moved performer");
    draft.add_performer("carl", "a.nvv", {1.1, 0, -0.4});
    live.expect_change("duplicated performer");
    draft.remove_node("bert");
    live.expect_change("removed performer");
    draft.root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = 30;
    live.expect_change("dimmed light");
    draft.node("lamp")["translation"] = {-1, 3, 1.5};
    live.expect_change("moved light");
    draft.settings()["background"] = {0.1, 0.3, 0.5};
    draft.settings()["shadows"] = false;
    live.expect_change("settings");
    draft.root["nodes"][1]["translation"] = {-0.5, 0.2, 0.3};
    live.expect_change("moved mesh");
    EXPECT_EQ(&live.renderer.field(0), field);
    EXPECT_EQ(live.renderer.frames().slices().performer(), performer) << "its slices and pipelines";
    EXPECT_EQ(device().buffer_bytes(), bytes);
}

// The stage at some times, with other lights, performers, set and camera in each image.
std::vector<stage::EvaluatedStage> changing(const stage::Stage& stage) {
    std::vector<stage::EvaluatedStage> all;
    for (uint32_t i = 0; i < 6; ++i) {
        stage::EvaluatedStage& one = all.emplace_back(stage::stage_at(stage, 0.04 * i));
        one.lights[0].position.x += 0.4 * i;
        one.performers[0].world_from_performer[3].x += 0.1 * i;
        one.performers[1].visible = i % 3 != 1;
        if (i > 3) one.pose.world_from_node[1][3].y += 0.1 * i;
    }
    return all;
}

// The host shows the stage for the next image while the device draws the one before.
TEST_F(StageRendererTest, ImagesUnderWayAreThoseThatOneWaitsFor) {
    Draft draft;
    Live live{device(), draft}, submitted{device(), draft};
    constexpr uint64_t kBytes = uint64_t{4} * kWidth * kHeight;
    const std::vector<stage::EvaluatedStage> all = changing(*live.stage);
    const auto camera = [](size_t i) {
        return look_at({0.4 - 0.2 * static_cast<double>(i), 1.6, 4.2}, {0.2, 0.5, 0}, kWidth, kHeight, 1.1);
    };
    std::vector<media::Image> expected;
    std::vector<gpu::Buffer> kept;
    for (size_t i = 0; i < all.size(); ++i) {
        live.renderer.show(all[i]);
        expected.push_back(live.renderer.frames().render(camera(i), live.renderer.settings_at(all[i])));
        kept.emplace_back(device(), "kept", kBytes, gpu::MemoryKind::kReadback);
    }
    submitted.image();  // makes what images need, so that nothing waits for the device
    for (size_t i = 0; i < all.size(); ++i) {
        submitted.renderer.show(all[i]);
        submitted.renderer.frames().submit({std::array{camera(i)}}, submitted.renderer.settings_at(all[i]),
                                           [&](gpu::Commands& commands, const gpu::Buffer& images) {
                                               gpu::compute_barrier(commands);
                                               gpu::copy(commands, images, kept[i], kBytes);
                                               gpu::host_barrier(commands);
                                           });
    }
    EXPECT_TRUE(submitted.renderer.frames().finish());
    for (size_t i = 0; i < all.size(); ++i) {
        const auto* pixels = kept[i].as<uint8_t>();
        EXPECT_TRUE(std::equal(expected[i].rgba.begin(), expected[i].rgba.end(), pixels)) << i;
        if (i > 0) {
            EXPECT_NE(expected[i].rgba, expected[i - 1].rgba);
        }
    }
}

TEST_F(StageRendererTest, TheSetChanges) {
    Draft draft;
    Live live{device(), draft};
    json first = draft.root["nodes"][3];
    draft.root["nodes"].erase(3);
    draft.root["nodes"].insert(draft.root["nodes"].begin(), first);
    draft.root["nodes"][2]["translation"] = {-0.5, 0.2, 0.3};
    live.expect_change("meshes on other nodes");
    add_mesh(draft.glb, sphere({-0.2, 0.3, 1.2}, 0.25f, 6), pbr_material({0.9f, 0.2f, 0.2f, 1}, 0.5, 0.4));
    live.expect_change("mesh node added");
    draft.root["nodes"].back()["translation"] = {0.1, 0.1, 0};
    live.expect_change("and moved");
    draft.root["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = {0.9, 0.9, 0.1, 1};
    live.expect_change("material");
    draft.root["materials"][1]["alphaMode"] = "BLEND";
    draft.root["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = {0.9, 0.9, 0.1, 0.5};
    live.expect_change("glass");
    draft.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
        test::add_texture(draft.glb, one_colour(40, 160, 200));
    live.expect_change("texture");
    draft.root["nodes"].erase(draft.root["nodes"].size() - 1);
    live.expect_change("mesh node removed");
}

TEST_F(StageRendererTest, TheEnvironmentChanges) {
    Draft draft;
    Live live{device(), draft};
    const auto set_environment = [&](const media::Image& image, const std::string& name) {
        media::write_png(draft.folder.path / name, image);
    };
    media::Image sky(32, 16);
    for (uint32_t i = 0; i < sky.rgba.size(); ++i) sky.rgba[i] = i % 4 == 3 ? 255 : static_cast<uint8_t>(i / 8);
    set_environment(sky, "sky.png");
    draft.settings()["environment"] = {{"uri", "sky.png"}};
    live.expect_change("environment");
    draft.settings()["environment"]["rotation"] = 40;
    live.expect_change("turned");
    set_environment(one_colour(30, 90, 200), "sky.png");
    live.expect_change("its file is another");
    draft.settings().erase("environment");
    live.expect_change("none");
}

TEST_F(StageRendererTest, ClipsComeAndGoAndAreWrittenAnew) {
    Draft draft;
    Live live{device(), draft};
    const std::filesystem::path folder = draft.folder.path;
    live.image();
    const render::Field* a = &live.renderer.field(0);
    voctree::write_nvv(folder / "b.nvv", clip_tree(2));
    draft.performer("anna")["uri"] = "b.nvv";
    live.expect_change("new clip");
    EXPECT_EQ(&live.renderer.field(1), a) << "the one that stays is not read again";
    voctree::write_nvv(folder / "a.nvv", clip_tree(3));
    live.expect_change("clip file replaced");
    EXPECT_NE(&live.renderer.field(1), a);
    const uint64_t two = device().buffer_bytes();
    draft.performer("bert")["uri"] = "b.nvv";
    live.expect_change("clip that nobody plays any more");
    EXPECT_LT(device().buffer_bytes(), two);
    EXPECT_EQ(live.stage->clips.size(), 1u);
    draft.remove_node("anna");
    draft.remove_node("bert");
    live.expect_change("a set alone");
    draft.add_performer("dora", "a.nvv", {0, 0, 0});
    live.expect_change("and somebody again");
}

TEST_F(StageRendererTest, AClipThatSomebodyStillHasComesBackWithoutReading) {
    Draft draft;
    Live live{device(), draft};
    voctree::write_nvv(draft.folder.path / "b.nvv", clip_tree(2));
    draft.performer("bert")["uri"] = "b.nvv";
    live.expect_change("two clips");
    const render::Field* b = &live.renderer.field(1);
    const std::shared_ptr<const render::Field> kept = live.renderer.shared_field(1);
    draft.performer("bert")["uri"] = "a.nvv";
    live.expect_change("one of them is gone");
    EXPECT_EQ(live.stage->clips.size(), 1u);
    draft.performer("bert")["uri"] = "b.nvv";
    live.expect_change("and comes back");
    EXPECT_EQ(&live.renderer.field(1), b);
    voctree::write_nvv(draft.folder.path / "b.nvv", clip_tree(3));
    live.expect_change("written anew");
    EXPECT_NE(&live.renderer.field(1), b);
}

// Paint of one colour on all leaves, in all frames.
voctree::EditLayer coat(const voctree::VOctree& tree, glm::vec3 colour) {
    voctree::EditLayer layer{voctree::painted_field(tree), {}};
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        layer.edits.push_back({leaf, 0, static_cast<float>(tree.frames - 1), colour, 1, voctree::kKeepSigma});
    return layer;
}

TEST_F(StageRendererTest, PaintOfASourceShowsAtOnce) {
    Draft draft;
    const voctree::VOctree tree = clip_tree(1);
    const std::filesystem::path unsaved = draft.folder.path / "unsaved.nvpaint";
    std::shared_ptr<const voctree::EditLayer> open;
    const render::PaintSource source = [&](const std::filesystem::path& layer) {
        return layer == unsaved ? voctree::PaintLayers{{layer, open}} : voctree::PaintLayers{};
    };
    Live live{device(), draft, draft.stage(), source};
    const render::Field* field = &live.renderer.field(0);
    open = std::make_shared<voctree::EditLayer>(coat(tree, {1, 0, 0}));
    draft.performer("anna")["paint"] = {{{"uri", "unsaved.nvpaint"}}};
    live.expect_change("painted");
    const uint64_t bytes = device().buffer_bytes();
    const uint32_t red = live.renderer.paint_of(0);
    draft.node("bert")["translation"] = {0.4, 0.2, -0.6};
    live.expect_change("something else");
    EXPECT_EQ(live.renderer.paint_of(0), red) << "the same layer is the same paint";
    open = std::make_shared<voctree::EditLayer>(coat(tree, {0, 0, 1}));
    live.expect_change("another stroke");
    EXPECT_NE(live.renderer.paint_of(0), red);
    EXPECT_EQ(live.renderer.frames().paints().find(red), nullptr);
    EXPECT_EQ(device().buffer_bytes(), bytes) << "the paint before is gone";
    draft.performer("bert")["paint"] = {{{"uri", "unsaved.nvpaint"}}};
    live.expect_change("shared by a copy");
    EXPECT_EQ(live.renderer.paint_of(0), live.renderer.paint_of(1));
    voctree::write_paint(draft.folder.path / "saved.nvpaint", coat(tree, {0, 1, 0}));
    draft.performer("anna")["paint"] = {{{"uri", "unsaved.nvpaint"}}, {{"uri", "saved.nvpaint"}, {"opacity", 0.5}}};
    live.expect_change("a layer on the disk");
    voctree::write_paint(draft.folder.path / "saved.nvpaint", coat(tree, {1, 1, 0}));
    live.expect_change("which was written anew");
    draft.performer("anna").erase("paint");
    live.expect_change("none on one");
    EXPECT_EQ(live.renderer.paint_of(0), 0u);
    EXPECT_EQ(&live.renderer.field(0), field);
}

TEST_F(StageRendererTest, WhatFailsLeavesTheStageBefore) {
    Draft draft;
    const voctree::VOctree tree = clip_tree(1), other = clip_tree(2);
    std::shared_ptr<const voctree::EditLayer> open;
    const render::PaintSource source = [&](const std::filesystem::path& layer) {
        return open ? voctree::PaintLayers{{layer, open}} : voctree::PaintLayers{};
    };
    Live live{device(), draft, draft.stage(), source};
    const media::Image before = live.image();
    const auto expect_refusal = [&](const std::string& what) {
        SCOPED_TRACE(what);
        draft.node("bert")["translation"] = {0.9, 0.2, -0.6};
        EXPECT_THROW(live.change(), InputError);
        EXPECT_EQ(live.image().rgba, before.rgba);
    };
    voctree::write_nvv(draft.folder.path / "b.nvv", other);
    draft.performer("anna")["uri"] = "b.nvv";
    open = std::make_shared<voctree::EditLayer>(coat(tree, {1, 0, 0}));
    draft.performer("anna")["paint"] = {{{"uri", "layer.nvpaint"}}};
    expect_refusal("paint of another clip");
    open = nullptr;
    expect_refusal("paint that is nowhere");
    draft.performer("anna").erase("paint");
    draft.settings()["environment"] = {{"uri", "sky.png"}};
    expect_refusal("no environment");
    draft.settings().erase("environment");
    const std::filesystem::path clip = draft.folder.path / "b.nvv";
    const std::unique_ptr<stage::Stage> next = draft.stage();  // reads only the header of the clip, which stays sound
    std::filesystem::resize_file(clip, std::filesystem::file_size(clip) - 100);
    EXPECT_THROW(live.renderer.change(*next, live.loader.load(*next)), InputError);
    EXPECT_EQ(live.image().rgba, before.rgba);
    voctree::write_nvv(clip, other);
    live.expect_change("all is well again");
}

}  // namespace
}  // namespace neuvv::test::stage_renderer_test
