// Highlights: leaves bound to bones and tinted, against the reference; and only on the instance that has one.
#include "render/volume/highlight.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include "reference/highlight.h"
#include "render/frame/frame_renderer.h"
#include "render/volume/shade.h"
#include "support/gpu_test.h"
#include "support/host_tree.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/traced.h"

namespace neuvv::test::highlight_test {
namespace {

using HighlightTest = GpuTest;

// Four bones across the box of random_tree, one of them a point, two of them thick.
std::vector<render::Bone> four_bones() {
    return {{{-0.9f, -0.2f, 0}, {0.1f, 0.2f, 0.1f}, 0.05f},
            {{0.1f, 0.2f, 0.1f}, {0.6f, 1.1f, 0.8f}, 0.1f},
            {{-0.2f, 0, 0.7f}, {-0.2f, 0, 0.7f}, 0.2f},
            {{-0.5f, 1, -0.6f}, {-0.4f, 0.5f, 0.9f}, 0.05f}};
}

std::vector<reference::Capsule> capsules_of(const std::vector<render::Bone>& bones) {
    std::vector<reference::Capsule> capsules;
    for (const render::Bone& bone : bones) capsules.push_back({bone.from, bone.to, bone.radius});
    return capsules;
}

glm::dvec3 centre_of(const voctree::VOctree& tree, const voctree::LeafPosition& position) {
    const double edge = std::exp2(-static_cast<double>(position.depth));
    return world_of(tree, edge * (glm::dvec3(position.x, position.y, position.z) + 0.5));
}

glm::dvec3 colour_of(glm::uvec2 words) {
    return {number(words.x, 16), number(words.y, 0), number(words.y, 16)};
}

TEST_F(HighlightTest, EachLeafIsTintedByItsNearestBoneAndChildNodesAreNot) {
    const voctree::VOctree tree = random_tree({.seed = 5, .node_levels = 3, .leaves = 4000, .hh_degree = 1});
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const render::LiveLeaves live(device(), field, field.leaf_count);
    const render::SliceTrees trees(device(), field, render::max_entries(field), 2);
    const render::TreeSlicer slicer(device(), field, live, trees);
    const gpu::Buffer shaded = render::shaded_entries(device(), trees.capacity, 2);
    const render::Shader shader(device(), field, trees, shaded);
    render::BoneBinder binder(device(), field, trees);
    const render::Highlighter highlighter(device(), binder, shaded);
    const std::vector<render::Bone> bones = four_bones();
    const std::vector<float> tints = {0, 1, 0.4f, 0.8f};
    std::vector<glm::uvec2> plain(trees.capacity), red(trees.capacity);
    const auto view_of = [&](std::vector<glm::uvec2>& to) {  // the second of two views
        std::vector<glm::uvec2> both(size_t{2} * trees.capacity);
        gpu::download(device(), shaded, both.data(), both.size() * sizeof(glm::uvec2));
        to.assign(both.begin() + trees.capacity, both.end());
    };
    gpu::run_once(device(), "shade", [&](gpu::Commands& commands) {
        render::record_slice_tree(commands, slicer, 0, 1);
        render::record_slice_tree(commands, slicer, 1, 2.5f);
        render::record_shade(commands, shader, 1, 1, {3, 1, 2});
    });
    view_of(plain);
    gpu::run_once(device(), "highlight", [&](gpu::Commands& commands) {
        render::record_bind_bones(commands, binder, 1, 7, bones);
        render::record_highlight(commands, highlighter, 1, 1, tints);
    });
    view_of(red);
    std::vector<uint32_t> leaves(size_t{2} * trees.capacity);
    std::vector<LiveCount> counts(2);
    gpu::download(device(), trees.entry_leaf, leaves.data(), leaves.size() * sizeof(uint32_t));
    gpu::download(device(), trees.counts, counts.data(), counts.size() * sizeof(LiveCount));
    std::array<uint32_t, 4> leaves_of_bone{};
    for (uint32_t entry = 0; entry < counts[1].slots; ++entry) {
        const uint32_t leaf = leaves[trees.capacity + entry];
        if (leaf == kNoLeaf) {
            EXPECT_EQ(red[entry], plain[entry]) << "the entry of a child node changed";
            continue;
        }
        const size_t bone = reference::nearest_bone(capsules_of(bones), centre_of(tree, positions[leaf]));
        ++leaves_of_bone[bone];
        const double tint = std::round(255.0 * tints[bone]) / 255;
        const glm::dvec3 truth = reference::tinted(colour_of(plain[entry]), tint);
        EXPECT_LT(glm::length(colour_of(red[entry]) - truth), 1e-3) << "leaf " << leaf;
        EXPECT_EQ(red[entry].x & 0xffffu, plain[entry].x & 0xffffu) << "the density changed";
    }
    for (size_t bone = 0; bone < bones.size(); ++bone) EXPECT_GT(leaves_of_bone[bone], 5u) << "bone " << bone;
}

TEST_F(HighlightTest, ASliceIsBoundAgainOnlyWhereItOrTheBonesChanged) {
    const voctree::VOctree tree = random_tree({.seed = 6});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const render::SliceTrees trees(device(), field, render::max_entries(field), 1);
    render::BoneBinder binder(device(), field, trees);
    std::vector<render::Bone> bones = four_bones();
    gpu::Commands commands(device(), "bind", 8);
    const auto binds = [&](uint64_t build) {
        commands.begin();
        render::record_bind_bones(commands, binder, 0, build, bones);
        commands.submit();
        commands.wait();
        return !commands.pass_times().empty();
    };
    EXPECT_TRUE(binds(1));
    EXPECT_FALSE(binds(1));
    EXPECT_TRUE(binds(2));
    bones[2].radius = 0.3f;
    EXPECT_TRUE(binds(2));
    EXPECT_FALSE(binds(2));
}

// Two instances of one slice, side by side; the first has a highlight. `apart` is the distance between them.
void expect_only_the_first_is_red(const gpu::Device& device, float apart) {
    constexpr uint32_t kWidth = 96, kHeight = 48;
    const voctree::VOctree tree = random_tree({.seed = 8, .node_levels = 3, .leaves = 900});
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, {kWidth, kHeight});
    render::FrameSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.mode = render::TraceMode::kShaded;
    settings.instances = {{1, placed({-0.5f * apart, 0, 0}, 0, glm::vec3(1))},
                          {1, placed({0.5f * apart, 0, 0}, 0, glm::vec3(1))}};
    const stage::Camera camera = look_at({0, 0.5, 8}, {0, 0.5, 0}, kWidth, kHeight, 1.4);
    const media::Image plain = renderer.render(camera, settings);
    const render::Highlight highlight{four_bones(), {1, 1, 1, 1}};
    settings.instances[0].highlight = std::make_shared<render::Highlight>(highlight);
    const media::Image red = renderer.render(camera, settings);
    uint32_t redder = 0;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const size_t at = 4 * (size_t{y} * kWidth + x);
            const int gained = red.rgba[at] - plain.rgba[at], lost = plain.rgba[at + 1] - red.rgba[at + 1];
            if (x < kWidth / 2) {
                redder += gained > 20 || lost > 20;
            } else if (apart > 2) {
                EXPECT_EQ(gained, 0) << x << ", " << y;
                EXPECT_EQ(lost, 0) << x << ", " << y;
            }
        }
    EXPECT_GT(redder, 100u);
    settings.instances[0].highlight.reset();
    EXPECT_EQ(renderer.render(camera, settings).rgba, plain.rgba) << "the highlight stayed";
}

TEST_F(HighlightTest, OnlyTheInstanceThatHasOneIsTinted) {
    expect_only_the_first_is_red(device(), 3);
}

TEST_F(HighlightTest, MergedInstancesAreTinted) {
    expect_only_the_first_is_red(device(), 0.8f);
}

}  // namespace
}  // namespace neuvv::test::highlight_test
