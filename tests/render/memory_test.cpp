// Where the device has no memory left, images are drawn with fewer slices, and look the same.
#include <gtest/gtest.h>

#include "render/frame/frame_renderer.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"

namespace neuvv::test::memory_test {
namespace {

constexpr uint32_t kSide = 40;
constexpr uint64_t kMiB = uint64_t{1} << 20;

TEST(SliceBudget, FollowsWhatTheDeviceHasLeft) {
    const auto budget = [](uint64_t size, std::optional<uint64_t> process, uint64_t used, uint64_t wanted) {
        return render::slice_budget({size * kMiB, process ? std::optional(*process * kMiB) : std::nullopt, used * kMiB},
                                    wanted * kMiB);
    };
    EXPECT_EQ(budget(8000, 6000, 1000, 256), 256 * kMiB) << "what is wanted";
    EXPECT_EQ(budget(8000, 6000, 5900, 256), 50 * kMiB) << "half of what is left";
    EXPECT_EQ(budget(8000, 6000, 6000, 256), 1u) << "one slice of each field";
    EXPECT_EQ(budget(8000, 6000, 7000, 256), 1u) << "others have taken it";
    EXPECT_EQ(budget(8000, std::nullopt, 7000, 256), 256 * kMiB) << "it is not known what is left";
    EXPECT_EQ(budget(800, std::nullopt, 0, 256), 100 * kMiB);
    EXPECT_EQ(budget(8000, 6000, 5900, 0), 0u) << "no slices are wanted";
}

struct FewSlices : GpuTest {
    voctree::VOctree tree =
        random_tree({.seed = 3, .node_levels = 3, .leaves = 6000, .bases = 5, .hh_degree = 2, .frames = 8});
    render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    stage::Camera camera = look_at({1.2, 1.5, 9}, {0, 0.4, 0}, kSide, kSide);
    render::FrameRenderer limited{device(), field, {kSide, kSide}};

    ~FewSlices() override { device().limit_memory(std::nullopt); }
    static void allow_more(uint64_t bytes) {
        device().memory_pool().clear(device().handle());
        device().limit_memory(device().memory_pool().allocated() + bytes);
    }
    render::FrameSettings settings_at(float frame) const {
        render::FrameSettings settings;
        settings.instances = {{frame}};
        settings.width = settings.height = kSide;
        settings.mode = render::TraceMode::kPlay;
        return settings;
    }
    media::Image image(render::FrameRenderer& renderer, float frame) const {
        return renderer.render(camera, settings_at(frame));
    }
    std::vector<media::Image> images(render::FrameRenderer& renderer) const {
        std::vector<media::Image> images;
        for (const float frame : {0.0f, 7.0f, 3.0f, 0.0f, 4.5f, 7.0f}) images.push_back(image(renderer, frame));
        return images;
    }
    // The images of a renderer that has memory for all slices, and the memory that these take.
    std::vector<media::Image> expected;
    uint64_t slices_bytes = 0;
    void draw_expected() {
        render::FrameRenderer plenty(device(), field, {kSide, kSide});
        expected = images(plenty);
        const render::SliceTrees& trees = plenty.slices().performer()->slices()->trees();
        ASSERT_EQ(trees.slices, field.frames);
        slices_bytes = trees.slices * render::slice_bytes(field, trees.capacity);
        EXPECT_NE(expected[0].rgba, expected[1].rgba) << "time is seen";
    }
    void expect_same(const std::vector<media::Image>& found) const {
        ASSERT_EQ(found.size(), expected.size());
        for (size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].rgba, expected[i].rgba) << i;
    }
    uint32_t slices() const { return limited.slices().performer()->slices()->trees().slices; }
};

TEST_F(FewSlices, LookAsManyDo) {
    draw_expected();
    allow_more(slices_bytes);  // the other passes need some of it
    expect_same(images(limited));
    EXPECT_LT(slices(), field.frames);
    EXPECT_GT(slices(), 1u) << "no fewer than must be";
    EXPECT_LT(limited.slices().budget(), slices_bytes);
}

TEST_F(FewSlices, AreKeptWhereMemoryGetsShortLater) {
    draw_expected();
    image(limited, 0);
    ASSERT_EQ(slices(), field.frames);
    const render::Field other = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    allow_more(kMiB);
    limited.change_fields({&field, &other});  // the other needs slices, too
    expect_same(images(limited));
    EXPECT_LT(slices(), field.frames);
}

TEST_F(FewSlices, GiveTheirMemoryToWhatElseNeedsIt) {
    draw_expected();
    image(limited, 0);
    allow_more(kMiB);
    const auto make = [&] { return gpu::Buffer(device(), "a clip", slices_bytes / 2, gpu::MemoryKind::kDevice); };
    EXPECT_THROW(make(), gpu::VulkanError);
    const gpu::Buffer made = render::with_memory_of_slices(limited, make);
    EXPECT_EQ(made.bytes, slices_bytes / 2);
    EXPECT_EQ(limited.slices().performer(), nullptr) << "all are gone";
    expect_same(images(limited));
    EXPECT_LE(slices(), field.frames / 2);
    EXPECT_GE(slices(), 1u);
}

TEST_F(FewSlices, AreNotEnoughWhereOneDoesNotFit) {
    draw_expected();
    allow_more(0);
    try {
        image(limited, 0);
        ADD_FAILURE() << "there was memory";
    } catch (const gpu::VulkanError& error) {
        EXPECT_TRUE(error.out_of_memory());
        EXPECT_NE(std::string(error.what()).find("less memory for slices"), std::string::npos) << error.what();
    }
    EXPECT_THROW(image(limited, 0), gpu::VulkanError) << "and again";
    device().limit_memory(std::nullopt);
    expect_same(images(limited));
}

// Slices have room for a part of a clip's leaves; where a frame has more live leaves, they need more room later.
TEST_F(FewSlices, GrowWithinTheMemory) {
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)  // all leaves live at all times
        for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] = std::abs(tree.leaf(leaf)[c]);
    for (float& value : tree.sigma_basis) value = std::abs(value);
    field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer plenty(device(), field, {kSide, kSide}), short_of(device(), field, {kSide, kSide});
    expected = images(plenty);
    const render::SliceTrees& trees = plenty.slices().performer()->slices()->trees();
    allow_more(trees.slices * render::slice_bytes(field, trees.capacity) * 3 / 4);
    expect_same(images(short_of));
    EXPECT_LT(short_of.slices().performer()->slices()->trees().slices, field.frames);
    EXPECT_EQ(short_of.slices().performer()->slices()->trees().capacity, trees.capacity);
}

}  // namespace
}  // namespace neuvv::test::memory_test
