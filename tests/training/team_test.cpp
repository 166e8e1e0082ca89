// Several members that train one tree together, against one that has all of their tiles.
#include "training/step/team.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "base/error.h"
#include "support/gpu_test.h"
#include "support/sphere_renders.h"
#include "support/thread_team.h"
#include "training/run/checkpoint.h"
#include "training/run/train.h"
#include "training/step/batch.h"
#include "training/step/gradient_records.h"
#include "training/tree/first_tree.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

using Words = std::vector<uint32_t>;

training::Bytes bytes_of(const Words& words) {
    const auto* first = reinterpret_cast<const uint8_t*>(words.data());
    return {first, first + sizeof(uint32_t) * words.size()};
}

uint32_t bits(float value) {
    return std::bit_cast<uint32_t>(value);
}

TEST(RecordSum, AddsGradientsLeafByLeaf) {
    training::RecordSum sum(10, 4);  // records: leaf, largest weight, two numbers
    const Words first{7, bits(0.5f), bits(1), bits(2), 3, bits(0.1f), bits(-1), bits(4)};
    const Words second{3, bits(0.2f), bits(0.5f), bits(-4), 9, bits(0.3f), bits(8), bits(9)};
    for (int repeat = 0; repeat < 2; ++repeat) {  // nothing is left of the first call
        const std::span<const uint32_t> result = sum.add_up({bytes_of(first), bytes_of(second)});
        EXPECT_EQ(Words(result.begin(), result.end()), (Words{7, bits(0.5f), bits(1), bits(2), 3, bits(0.2f),
                                                              bits(-0.5f), bits(0), 9, bits(0.3f), bits(8), bits(9)}));
    }
}

TEST(RecordSum, RefusesWhatDoesNotFit) {
    const Words foreign{10, 0, 0, 0}, cut{3, 0, 0};
    EXPECT_THROW(training::RecordSum(10, 4).add_up({bytes_of(foreign)}), RuntimeFailure);
    EXPECT_THROW(training::RecordSum(10, 4).add_up({bytes_of(cut)}), RuntimeFailure);
}

TEST(RecordSum, EachMemberAddsUpItsShareOfTheLeaves) {
    const Words records{7, 10, 3, 11, 6, 12, 4, 13};  // of two words
    EXPECT_EQ(training::divide_records(records, 2, 3),
              (std::vector<training::Bytes>{bytes_of({3, 11, 6, 12}), bytes_of({7, 10, 4, 13}), {}}));
}

TEST(RecordSum, SumsOfAllSharesStandBehindEachOther) {
    const std::vector<training::Bytes> shares{bytes_of({3, 11, 6, 12}), {}, bytes_of({5, 10})};
    Words room(6);
    EXPECT_EQ(training::take_sums(shares, 7, 2, room), 3u);
    EXPECT_EQ(room, (Words{3, 11, 6, 12, 5, 10}));
    EXPECT_THROW(training::take_sums(shares, 6, 2, room), RuntimeFailure) << "the tree has no leaf 6";
    EXPECT_THROW(training::take_sums({shares[0], shares[2], {}}, 7, 2, room), RuntimeFailure) << "another's share";
    EXPECT_THROW(training::take_sums(shares, 7, 4, room), RuntimeFailure) << "half a record";
    EXPECT_THROW(training::take_sums(shares, 7, 2, std::span(room).first(4)), RuntimeFailure) << "no room";
}

TEST(Team, ValuesComeInTheOrderOfRanks) {
    std::vector<std::vector<int>> heard(3);
    run_team(3, [&](const training::Team& team) {
        heard[team.rank] = training::gather_values(team, 10 * static_cast<int>(team.rank));
    });
    for (const std::vector<int>& values : heard) EXPECT_EQ(values, (std::vector<int>{0, 10, 20}));
    EXPECT_EQ(training::gather_values({}, 5), std::vector<int>{5});
}

TEST(Team, MembersExchangeMessages) {
    run_team(3, [&](const training::Team& team) {
        std::vector<training::Bytes> to;
        for (uint8_t i = 0; i < 3; ++i) to.push_back(training::Bytes(i, static_cast<uint8_t>(team.rank)));
        const std::vector<training::Bytes> from = team.exchange(to);
        ASSERT_EQ(from.size(), 3u);
        for (uint8_t i = 0; i < 3; ++i) EXPECT_EQ(from[i], training::Bytes(team.rank, i));
    });
}

TEST(Team, AMemberThatIsOutOfStepIsNoticed) {
    run_team(2, [](const training::Team& team) {
        if (team.is_first())
            EXPECT_THROW(training::gather_values(team, uint64_t{1}), RuntimeFailure);
        else
            EXPECT_THROW(training::gather_values(team, uint32_t{1}), RuntimeFailure);
    });
}

TEST(Team, AllMembersGetTheFirstOnesTree) {
    const voctree::VOctree coarse =
        training::initial_tree(trained_sphere(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 2);
    const voctree::VOctree fine =
        training::initial_tree(trained_sphere(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 1);
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
    const voctree::VOctree tree =
        training::initial_tree(trained_sphere(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 2);
    run_team(2, [&](const training::Team& team) {
        voctree::VOctree own = tree;
        if (team.is_first()) return training::adopt_first_tree(team, own);
        own.hh_degree = 2;
        EXPECT_THROW(training::adopt_first_tree(team, own), RuntimeFailure);
    });
}

struct TeamTest : GpuTest {
    static const gpu::Device& shared_device() { return device(); }
};

// The gradients of all weights (in the first moments) and the largest blending weights after one step of the first
// batch.
struct Gradients {
    std::vector<float> weights;
    training::LeafUse use;
    training::StepResult result;
};

Gradients gradients_of_a_step(const gpu::Device& device, const voctree::VOctree& tree, const training::Team& team) {
    constexpr uint32_t kTiles = 120;  // of all members together
    training::BatchSampler sampler(trained_sphere(), kTiles, 5);
    const training::Batch batch = sampler.next(1, team.rank, team.size);
    EXPECT_EQ(batch.tiles.size(), kTiles * (team.rank + 1) / team.size - kTiles * team.rank / team.size);
    training::TrainingStep step(device, tree, kTrainedSphere.cameras, kTiles, team);
    training::load_batch(trained_sphere(), batch, step.rays(), step.batch());
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
    const voctree::VOctree tree =
        training::initial_tree(trained_sphere(), {.resolution = 40, .bases = 3, .hh_degree = 1}, 1);
    const Gradients alone = gradients_of_a_step(device(), tree, {});
    std::vector<Gradients> together(3);
    run_team(3, [&](const training::Team& team) { together[team.rank] = gradients_of_a_step(device(), tree, team); });
    double largest = 0;
    for (const float gradient : alone.weights) largest = std::max(largest, std::abs(static_cast<double>(gradient)));
    ASSERT_GT(largest, 0.1);
    for (const Gradients& member : together) {
        ASSERT_EQ(member.weights.size(), alone.weights.size());
        for (size_t i = 0; i < alone.weights.size(); ++i)
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

training::TrainSettings run_of(uint32_t tiles, uint32_t bases, const training::Team& team) {
    training::TrainSettings settings;
    settings.steps = 60;
    settings.shape = {.resolution = 40, .bases = bases, .hh_degree = 1};
    settings.tiles_per_step = tiles;
    settings.team = team;
    return settings;
}

// What a member's device holds at the end.
struct Member {
    training::TrainProgress last;
    std::vector<float> weights, sigma_basis;
};

Member train_member(const training::TrainSettings& settings, const std::filesystem::path& nvv) {
    training::Dataset own = trained_sphere();
    Member member;
    const auto look = [&](const training::TrainProgress& now) {
        const gpu::Buffer &weights = now.field->whole_weights(), &basis = now.field->sigma_basis;
        member.weights.resize(weights.bytes / sizeof(float));
        member.sigma_basis.resize(basis.bytes / sizeof(float));
        gpu::download(*weights.device, weights, member.weights.data(), weights.bytes);
        gpu::download(*basis.device, basis, member.sigma_basis.data(), basis.bytes);
        return true;
    };
    member.last = training::train(TeamTest::shared_device(), own, settings, nvv, look);
    return member;
}

// Through all changes of the tree, with a basis for each frame and with shared ones: all members end with the same
// numbers, and with a model as good as that of one process with as many tiles a step. Only the first writes files.
TEST_F(TeamTest, ARunEndsAsThatOfOneProcess) {
    for (const uint32_t bases : {3u, 2u}) {
        const TemporaryFolder folder;
        const Member alone = train_member(run_of(128, bases, {}), folder.path / "alone.nvv");
        std::vector<Member> members(2);
        run_team(2, [&](const training::Team& team) {
            members[team.rank] =
                train_member(run_of(64, bases, team), folder.path / (team.is_first() ? "team.nvv" : "no.nvv"));
        });
        EXPECT_FALSE(std::filesystem::exists(folder.path / "no.nvv"));
        for (const Member& member : members) {
            EXPECT_EQ(member.last.step, 60u);
            EXPECT_NEAR(member.last.epochs, alone.last.epochs, 1e-9);
            EXPECT_EQ(member.weights, members[0].weights);
            EXPECT_EQ(member.sigma_basis, members[0].sigma_basis);
        }
        const auto leaves = static_cast<double>(voctree::read_nvv(folder.path / "alone.nvv").leaf_count);
        EXPECT_NEAR(voctree::read_nvv(folder.path / "team.nvv").leaf_count / leaves, 1, 0.05);
        const auto renders_of = [&](const char* name) {
            return held_out_renders(device(), kTrainedSphere, folder.path / name);
        };
        EXPECT_GT(mean_psnr(renders_of("alone.nvv"), renders_of("team.nvv")), 38);  // as two runs of one seed
    }
}

// Where a batch has fewer image tiles than there are members, some trace nothing.
TEST_F(TeamTest, MembersWithoutTilesGoOn) {
    std::vector<uint64_t> steps(5);
    run_team(5, [&](const training::Team& team) {
        training::TrainSettings settings = run_of(1, 3, team);
        settings.steps = 60;  // so that times reach the ends of their epochs, where few tiles are left
        steps[team.rank] = train_member(settings, {}).last.step;
    });
    EXPECT_EQ(steps, (std::vector<uint64_t>(5, 60)));
}

TEST_F(TeamTest, MembersWithOtherDataAreRefused) {
    training::Dataset other = trained_sphere();
    other.cameras[0].fx *= 1.01;
    EXPECT_THROW(run_team(2,
                          [&](const training::Team& team) {
                              training::Dataset own = team.is_first() ? trained_sphere() : other;
                              training::train(device(), own, run_of(64, 3, team), {},
                                              [](const training::TrainProgress&) { return true; });
                          }),
                 InputError);
}

TEST_F(TeamTest, AnyMemberCanStopAll) {
    const TemporaryFolder folder;
    std::vector<training::Dataset> captures{trained_sphere(), trained_sphere()};
    std::vector<training::TrainProgress> last(2);
    run_team(2, [&](const training::Team& team) {
        training::TrainSettings settings = run_of(64, 3, team);
        settings.steps = 10000000;
        last[team.rank] = training::train(device(), captures[team.rank], settings, folder.path / "team.nvv",
                                          [&](const training::TrainProgress&) { return team.is_first(); });
    });
    EXPECT_EQ(last[0].step, last[1].step);
    EXPECT_EQ(training::load_checkpoint(folder.path / "team.nvv").run.step, last[0].step);
}

}  // namespace
}  // namespace neuvv::test
