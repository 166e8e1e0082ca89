// Renderers of stages that are resized, that are full, and that draw large images in blocks.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "gpu/host_copies.h"
#include "reference/slice.h"
#include "render/clips/stage_renderer.h"
#include "render/stage_draft.h"
#include "support/figure.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"
#include "support/set_scene.h"
#include "voctree/files/nvv.h"

namespace neuvv::test::stage_renderer_test {
namespace {

TEST_F(StageRendererTest, ResizedIsAsMadeOfThatSize) {
    Draft draft;
    Live live{device(), draft};
    live.image();
    const render::Performer* performer = live.renderer.frames().slices().performer();
    for (const glm::uvec2 size : {glm::uvec2(90, 40), glm::uvec2(30, 70), glm::uvec2(20, 20), glm::uvec2(90, 70)}) {
        SCOPED_TRACE(std::to_string(size.x) + "x" + std::to_string(size.y));
        live.renderer.resize(size.x, size.y);
        render::StageRenderer fresh(device(), *live.stage, render::StageLoader(device()).load(*live.stage),
                                    {size.x, size.y});
        const media::Image image = live.image();
        EXPECT_EQ(image.width, size.x);
        EXPECT_EQ(image.rgba, drawn(fresh, *live.stage).rgba);
        EXPECT_EQ(live.renderer.frames().slices().performer(), performer) << "with its slices";
    }
    draft.node("anna")["translation"] = {-0.6, 0.2, 0.1};
    live.change();
    render::StageRenderer fresh(device(), *live.stage, render::StageLoader(device()).load(*live.stage), {90, 70});
    EXPECT_EQ(live.image().rgba, drawn(fresh, *live.stage).rgba) << "and is changed afterwards";
}

TEST_F(StageRendererTest, ImagesMayStayOnTheDevice) {
    Draft draft;
    Live live{device(), draft};
    const media::Image image = live.image();
    const stage::EvaluatedStage evaluated = stage::stage_at(*live.stage, 0.06);
    render::FrameSettings settings = live.renderer.settings_at(evaluated);
    settings.instances.clear();
    const stage::Camera camera = camera_of_size(kWidth, kHeight);
    render::FrameRenderer& frames = live.renderer.frames();
    frames.render(camera, settings);  // overwrites the image
    const gpu::Buffer& kept = frames.draw({&camera, 1}, live.renderer.settings_at(evaluated));
    std::vector<uint8_t> bytes(image.rgba.size());
    gpu::download(device(), kept, bytes.data(), bytes.size());
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), image.rgba.begin()));
}

TEST_F(StageRendererTest, NamesAStageOfTooManyPerformers) {
    Draft draft;
    for (uint32_t i = 2; i < render::kMaxInstances; ++i) draft.add_performer(fmt::format("{}", i), "a.nvv", {0, 0, 0});
    Live live{device(), draft};
    EXPECT_EQ(live.renderer.settings_at(stage::stage_at(*live.stage, 0)).instances.size(), render::kMaxInstances);
    draft.add_performer("one more", "a.nvv", {0, 0, 0});
    live.change();
    try {
        live.renderer.settings_at(stage::stage_at(*live.stage, 0.5));
        FAIL();
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("stage.glb: shows 513 performers at 0.5 s, an image 512 at most; hide"), std::string::npos)
            << text;
    }
    draft.performer("one more")["visible"] = false;
    live.change();
    EXPECT_EQ(live.renderer.settings_at(stage::stage_at(*live.stage, 0)).instances.size(), render::kMaxInstances);
}

TEST_F(StageRendererTest, LiveEntriesAreLeavesAndNodesThatLive) {
    Draft draft;
    Live live{device(), draft};
    live.image();
    const voctree::VOctree tree = clip_tree(1);
    uint64_t leaves = 0;
    for (const reference::LeafSlice& leaf :
         reference::slice_tree(tree, static_cast<double>(stage::stage_at(*live.stage, 0.06).performers[0].frame)))
        leaves += leaf.sigma > 0;
    const uint64_t entries = live.renderer.frames().live_entries();
    EXPECT_GE(entries, leaves);
    EXPECT_LE(entries, leaves + live.renderer.field(0).node_count());
    draft.add_performer("carl", "a.nvv", {1.1, 0, -0.4});
    live.change();
    live.image();
    EXPECT_EQ(live.renderer.frames().live_entries(), entries) << "copies share a slice";
    draft.remove_node("anna"), draft.remove_node("bert"), draft.remove_node("carl");
    live.change();
    live.image();
    EXPECT_EQ(live.renderer.frames().live_entries(), 0u);
}

// The camera of the part of an image from pixel (x, y) on.
stage::Camera part_of(stage::Camera camera, uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    camera.cx -= x;
    camera.cy -= y;
    camera.width = width;
    camera.height = height;
    return camera;
}

// The number of pixels that differ by more than a step. Glass and edges of the set may: in single precision, the
// rasteriser may round a vertex of the part to another 1/256 of a texel.
uint32_t unlike_pixels(const media::Image& a, const media::Image& b) {
    uint32_t unlike = 0;
    for (size_t pixel = 0; pixel < a.rgba.size(); pixel += 4) {
        int most = 0;
        for (size_t c = pixel; c < pixel + 4; ++c) most = std::max(most, std::abs(a.rgba[c] - b.rgba[c]));
        unlike += most > 1;
    }
    return unlike;
}

TEST_F(StageRendererTest, BlocksOfMoreSamplesMakeTheWholeImage) {
    constexpr uint32_t kWide = 160, kHigh = 120;
    Draft draft;
    voctree::write_nvv(draft.folder.path / "a.nvv", figure_tree());
    const std::unique_ptr<stage::Stage> stage = draft.stage();
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage, 0);
    const render::StageAssets assets = render::StageLoader(device()).load(*stage);
    render::StageRenderer fine(device(), *stage, assets, {kWide, kHigh, 2}),
        coarse(device(), *stage, assets, {kWide, kHigh, 1});
    fine.show(evaluated);
    coarse.show(evaluated);
    const stage::Camera camera = camera_of_size(kWide, kHigh);
    render::FrameSettings settings = fine.settings_at(evaluated);
    const auto put_together = [&](uint32_t samples) {
        media::Image image(kWide, kHigh);
        render::FrameSettings of_block = settings;
        of_block.width = kWide / 2;
        of_block.height = kHigh / 2;
        of_block.samples = samples;
        for (uint32_t i = 0; i < 4; ++i) {
            const uint32_t x = i % 2 * of_block.width, y = i / 2 * of_block.height;
            const media::Image block =
                coarse.frames().render(part_of(camera, x, y, of_block.width, of_block.height), of_block);
            for (uint32_t row = 0; row < of_block.height; ++row)
                std::copy_n(block.at(0, row), size_t{4} * of_block.width, image.at(x, y + row));
        }
        return image;
    };
    for (const render::TraceMode mode :
         {render::TraceMode::kTree, render::TraceMode::kPlay}) {  // kPlay selects the shading of each part by itself
        settings.mode = mode;
        const media::Image whole = fine.frames().render(camera, settings);
        EXPECT_GT(unlike_pixels(put_together(1), whole), kWide * kHigh / 50) << "so many samples do show";
        EXPECT_LE(unlike_pixels(put_together(2), whole), kWide * kHigh / 1000);
    }
    ASSERT_FALSE(coarse.frames().plan().drawn.empty());
    EXPECT_EQ(fine.frames().plan().drawn[0][0].shading, render::Shading::kPerLeaf);
    EXPECT_EQ(coarse.frames().plan().drawn[0][0].shading, render::Shading::kPerRay);
    settings.width = settings.height = 2 * kHigh;
    EXPECT_THROW(coarse.frames().render(camera_of_size(2 * kHigh, 2 * kHigh), settings), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test::stage_renderer_test
