// Several members that train one tree together, against one that has all of their tiles.
#include "training/team.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "base/error.h"
#include "support/gpu_test.h"
#include "support/sphere_renders.h"
#include "support/thread_team.h"
#include "training/batch.h"
#include "training/checkpoint.h"
#include "training/gradient_records.h"
#include "training/grow.h"
#include "training/train.h"
#include "voctree/nvv.h"

namespace neuvv::test {
namespace {

const SphereCapture kCapture;

training::Dataset& capture() {
    static training::Dataset dataset = sphere_dataset(kCapture);
    return dataset;
}

using Words = std::vector<uint32_t>;

uint32_t bits(float value) {
    return std::bit_cast<uint32_t>(value);
}

TEST(RecordSum, AddsGradientsLeafByLeaf) {
    training::RecordSum sum(10, 4);  // records: leaf, largest weight, two numbers
    const Words first{7, bits(0.5f), bits(1), bits(2), 3, bits(0.1f), bits(-1), bits(4)};
    const Words second{3, bits(0.2f), bits(0.5f), bits(-4), 9, bits(0.3f), bits(8), bits(9)};
    for (int repeat = 0; repeat < 2; repeat++) {  // nothing is left of the first call
        Words result(12);
        ASSERT_EQ(sum.add_up({first, second}, result.data(), 3), 3u);
        EXPECT_EQ(result, (Words{7, bits(0.5f), bits(1), bits(2), 3, bits(0.2f), bits(-0.5f), bits(0), 9, bits(0.3f),
                                 bits(8), bits(9)}));
    }
}

TEST(RecordSum, RefusesWhatDoesNotFit) {
    Words result(12);
    const Words record{3, 0, 0, 0}, other{4, 0, 0, 0}, foreign{10, 0, 0, 0}, cut{3, 0, 0};
    EXPECT_THROW(training::RecordSum(10, 4).add_up({record, other}, result.data(), 1), RuntimeFailure);
    EXPECT_THROW(training::RecordSum(10, 4).add_up({foreign}, result.data(), 3), RuntimeFailure);
    EXPECT_THROW(training::RecordSum(10, 4).add_up({cut}, result.data(), 3), RuntimeFailure);
}

TEST(Team, ValuesComeInTheOrderOfRanks) {
    std::vector<std::vector<int>> heard(3);
    run_team(3, [&](const training::Team& team) {
        heard[team.rank] = training::gather_values(team, 10 * static_cast<int>(team.rank));
    });
    for (const std::vector<int>& values : heard) EXPECT_EQ(values, (std::vector<int>{0, 10, 20}));
    EXPECT_EQ(training::gather_values({}, 5), std::vector<int>{5});
}

TEST(Team, AllMembersGetTheFirstOnesTree) {
    const voctree::VOctree coarse =
        training::initial_tree(capture(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 2);
    const voctree::VOctree fine = training::initial_tree(capture(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 1);
    run_team(2, [&](const training::Team& team) {
        voctree::VOctree tree = team.is_first() ? fine : coarse;
        training::adopt_first_tree(team, tree);
        EXPECT_EQ(tree.leaf_count, fine.leaf_count);
        EXPECT_EQ(tree.weights, fine.weights);
        EXPECT_EQ(tree.children, fine.children);
        EXPECT_EQ(tree.sigma_basis, fine.sigma_basis);
    });
}

TEST(Team, ATreeOfAnotherShapeIsRefused) {
    const voctree::VOctree tree = training::initial_tree(capture(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 2);
    run_team(2, [&](const training::Team& team) {
        voctree::VOctree own = tree;
        if (team.is_first()) return training::adopt_first_tree(team, own);
        own.hh_degree = 2;
        EXPECT_THROW(training::adopt_first_tree(team, own), RuntimeFailure);
    });
}

using TeamTest = GpuTest;

// The gradients of all weights (in the first moments) and the largest blending weights after one step of the first
// batch.
struct Gradients {
    std::vector<float> weights;
    training::LeafUse use;
    training::StepResult result;
};

Gradients gradients_of_a_step(const gpu::Device& device, const voctree::VOctree& tree, const training::Team& team) {
    constexpr uint32_t kTiles = 120;  // of all members together
    training::BatchSampler sampler(capture(), kTiles, 5);
    const training::Batch batch = sampler.next(1, team.rank, team.size);
    EXPECT_EQ(batch.tiles.size(), kTiles * (team.rank + 1) / team.size - kTiles * team.rank / team.size);
    training::TrainingStep step(device, tree, kCapture.cameras, kTiles, team);
    training::load_batch(capture(), batch, step.rays(), step.batch());
    training::StepSettings settings;
    settings.frame = static_cast<float>(training::frame_of_time(batch.time, tree.frames));
    settings.tiles = static_cast<uint32_t>(batch.tiles.size());
    settings.weights = training::kDefaultLossWeights;
    settings.adam.emit_only = true;
    step.submit(settings);
    Gradients gradients;
    gradients.result = step.wait();
    gradients.weights.resize(step.moments().first.bytes / sizeof(float));
    gpu::download(device, step.moments().first, gradients.weights.data(), step.moments().first.bytes);
    gradients.use = training::read_use(device, step.tally(), tree);
    return gradients;
}

TEST_F(TeamTest, AStepHasTheGradientsOfAllMembersTiles) {
    const voctree::VOctree tree = training::initial_tree(capture(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 1);
    const Gradients alone = gradients_of_a_step(device(), tree, {});
    std::vector<Gradients> together(3);
    run_team(3, [&](const training::Team& team) { together[team.rank] = gradients_of_a_step(device(), tree, team); });
    double largest = 0;
    for (const float gradient : alone.weights) largest = std::max(largest, std::abs(static_cast<double>(gradient)));
    ASSERT_GT(largest, 0.1);
    for (const Gradients& member : together) {
        ASSERT_EQ(member.weights.size(), alone.weights.size());
        for (size_t i = 0; i < alone.weights.size(); i++)
            ASSERT_NEAR(member.weights[i], alone.weights[i], 1e-5 * largest) << "number " << i;
        EXPECT_EQ(member.weights, together[0].weights) << "all members move alike";
        EXPECT_EQ(member.use.max_weight, alone.use.max_weight);
        EXPECT_EQ(member.use.frames, alone.use.frames);
        EXPECT_EQ(member.result.pixels, alone.result.pixels);
        EXPECT_EQ(member.result.touched, alone.result.touched);
        EXPECT_NEAR(member.result.rgb_loss, alone.result.rgb_loss, 1e-6 * alone.result.rgb_loss);
        EXPECT_NEAR(member.result.grad_loss, alone.result.grad_loss, 1e-6 * alone.result.grad_loss);
    }
}

training::TrainSettings run_of(uint32_t tiles, const training::Team& team) {
    training::TrainSettings settings;
    settings.steps = 60;
    settings.shape = {.resolution = 40, .bases = 3, .hh_degree = 1};
    settings.tiles_per_step = tiles;
    settings.team = team;
    return settings;
}

// Through all changes of the tree: both members end with the same tree, as good as that of one process with as many
// tiles a step. Only the first writes files.
TEST_F(TeamTest, ARunEndsAsThatOfOneProcess) {
    const TemporaryFolder folder;
    const auto go_on = [](const training::TrainProgress&) { return true; };
    const training::TrainProgress alone =
        training::train(device(), capture(), run_of(128, {}), folder.path / "alone.nvv", go_on);
    std::vector<training::Dataset> captures{capture(), capture()};
    std::vector<training::TrainProgress> last(2);
    run_team(2, [&](const training::Team& team) {
        last[team.rank] = training::train(device(), captures[team.rank], run_of(64, team),
                                          folder.path / (team.is_first() ? "team.nvv" : "no.nvv"), go_on);
    });
    EXPECT_FALSE(std::filesystem::exists(folder.path / "no.nvv"));
    for (const training::TrainProgress& member : last) {
        EXPECT_EQ(member.step, 60u);
        EXPECT_EQ(member.depth, last[0].depth);
        EXPECT_NEAR(member.epochs, alone.epochs, 1e-9);
    }
    const auto leaves = static_cast<double>(voctree::read_nvv(folder.path / "alone.nvv").leaf_count);
    EXPECT_NEAR(voctree::read_nvv(folder.path / "team.nvv").leaf_count / leaves, 1, 0.05);
    const auto renders_of = [&](const char* name) { return held_out_renders(device(), kCapture, folder.path / name); };
    EXPECT_GT(mean_psnr(renders_of("alone.nvv"), renders_of("team.nvv")), 40);  // as two runs of one seed
}

TEST_F(TeamTest, AnyMemberCanStopAll) {
    const TemporaryFolder folder;
    std::vector<training::Dataset> captures{capture(), capture()};
    std::vector<training::TrainProgress> last(2);
    run_team(2, [&](const training::Team& team) {
        training::TrainSettings settings = run_of(64, team);
        settings.steps = 10000000;
        last[team.rank] = training::train(device(), captures[team.rank], settings, folder.path / "team.nvv",
                                          [&](const training::TrainProgress&) { return team.is_first(); });
    });
    EXPECT_EQ(last[0].step, last[1].step);
    EXPECT_EQ(training::load_checkpoint(folder.path / "team.nvv").run.step, last[0].step);
}

}  // namespace
}  // namespace neuvv::test
