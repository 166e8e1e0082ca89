// The optimiser inside slice_adjoint.comp and rows_adjoint.comp, against that of the reference; and a test that it
// learns.
#include <gtest/gtest.h>

#include "gpu/host_copies.h"
#include "gradient/scene.h"
#include "reference/adam.h"
#include "support/gpu_test.h"
#include "training/tree/bases.h"

namespace neuvv::test {
namespace {

struct State {
    std::vector<float> weights, first, second;
};

State weights_now(const gpu::Device& device, const training::TrainingStep& step) {
    const size_t count = step.field().whole_weights().bytes / sizeof(float);
    return {download_floats(device, step.field().whole_weights(), count),
            download_floats(device, step.moments().first, count),
            download_floats(device, step.moments().second, count)};
}

// The rows of A, then those of B, with their moments.
State rows_now(const gpu::Device& device, const training::TrainingStep& step) {
    const size_t count = size_t{step.field().frames} * step.field().bases;
    State state{download_floats(device, step.field().sigma_basis, count),
                download_floats(device, step.moments().rows_first, 2 * count),
                download_floats(device, step.moments().rows_second, 2 * count)};
    const std::vector<float> gamma = download_floats(device, step.field().gamma_basis, count);
    state.weights.insert(state.weights.end(), gamma.begin(), gamma.end());
    return state;
}

struct Counts {
    size_t moved = 0, kept = 0;
};

// Expects that `after` is `before` moved by Adam along `gradient`, and that elements without a gradient have the same
// bits. Gradients that consist mostly of rounding errors of their atomic sums differ from run to run and are left out.
template <typename RateOf>
void expect_update(const State& before, const State& after, const std::vector<float>& gradient, const RateOf& rate_of,
                   const training::AdamSettings& adam, Counts& counts) {
    ASSERT_EQ(before.weights.size(), gradient.size());
    float largest = 0;
    for (const float g : gradient) largest = std::max(largest, std::abs(g));
    for (size_t i = 0; i < gradient.size(); ++i) {
        if (gradient[i] == 0) {
            ASSERT_EQ(after.weights[i], before.weights[i]);
            ASSERT_EQ(after.first[i], before.first[i]);
            ASSERT_EQ(after.second[i], before.second[i]);
            ++counts.kept;
            continue;
        }
        if (std::abs(gradient[i]) < 1e-4f * largest) continue;
        const double rate = rate_of(i);
        reference::AdamElement truth{before.weights[i], before.first[i], before.second[i]};
        reference::adam_update(truth, gradient[i], {rate, adam.beta1, adam.beta2, adam.epsilon},
                               reference::adam_bias(adam.beta1, adam.step),
                               reference::adam_bias(adam.beta2, adam.step));
        ASSERT_NEAR(after.first[i], truth.m, 1e-5 * std::abs(truth.m) + 1e-6 * largest) << i;
        ASSERT_NEAR(after.second[i], truth.v, 1e-3 * truth.v) << i;
        ASSERT_NEAR(after.weights[i], truth.weight, 1e-3 * rate + 1e-6 * std::abs(truth.weight)) << i;
        ASSERT_NE(after.weights[i], before.weights[i]) << i;
        ++counts.moved;
    }
}

using AdamTest = GpuTest;

// Three steps on different tiles: a leaf that is first seen in the third step gets the bias correction of the third
// step.
TEST_F(AdamTest, MovesWeightsAndRowsAsTheReferenceDoes) {
    const Scene all = random_scene({.tree = {.seed = 51, .leaves = 300, .bases = 5, .hh_degree = 2}});
    training::TrainingStep step(device(), all.tree, 2, 3);
    const training::LearningRates rates{
        .sigma = 0.3f, .gamma = 0.01f, .colour = 0.2f, .detail = 0.05f, .sigma_rows = 1e-2f, .gamma_rows = 2e-2f};
    const uint32_t basis_planes = step.field().basis_planes(), leaves = all.tree.leaf_count;
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(all.tree);
    const auto weight_rate = [&](size_t i) {
        const size_t plane = i / (size_t{4} * leaves);
        if (plane < basis_planes) {  // relative to the leaf's edge
            const voctree::LeafPosition& position = positions[i / 4 % leaves];
            return static_cast<double>(rates.sigma) * std::exp2(position.depth) /
                   static_cast<double>(all.tree.box_size.x);
        }
        if (plane < 2 * basis_planes) return static_cast<double>(rates.gamma);
        const size_t function = plane - 2 * basis_planes;
        const bool constant = function == 0 || function == 1 || function == 5;  // l = 0 of n = 0, 1, 2
        return static_cast<double>(constant ? rates.colour : rates.detail);
    };
    const auto row_rate = [&](size_t i) {
        const bool of_a = i < size_t{all.tree.frames} * all.tree.bases;
        return static_cast<double>(of_a ? rates.sigma_rows : rates.gamma_rows);
    };
    Counts weights, rows;
    for (uint32_t i = 1; i <= 3; ++i) {
        SCOPED_TRACE("step " + std::to_string(i));
        const Scene scene = with_tiles(all, 2 * i, 3, i);
        const Gradients gradients = emitted_gradients(device(), step, scene);
        const State weights_before = weights_now(device(), step), rows_before = rows_now(device(), step);
        training::StepSettings settings = settings_of(scene);
        settings.rates = rates;
        settings.adam.step = i;
        step.submit(settings);
        step.wait();
        expect_update(weights_before, weights_now(device(), step), gradients.weights, weight_rate, settings.adam,
                      weights);
        expect_update(rows_before, rows_now(device(), step), gradients.rows, row_rate, settings.adam, rows);
    }
    EXPECT_GT(weights.moved, 1000u);
    EXPECT_GT(weights.kept, 1000u);
    EXPECT_GT(rows.moved, 30u);
    EXPECT_GT(rows.kept, 30u);
}

// At a time between two frames, both frames use a leaf. A later step adds to the use.
TEST_F(AdamTest, LeavesRememberHowTheyWereUsed) {
    Scene scene = random_scene({.tree = {.seed = 54, .leaves = 300, .bases = 5, .hh_degree = 1}});
    ASSERT_GE(scene.tree.frames, 3u);
    training::TrainingStep step(device(), scene.tree, 2, static_cast<uint32_t>(scene.tiles.size()));
    training::StepSettings settings = settings_of(scene);
    settings.adam.min_used_weight = 0.05f;
    const auto run_at = [&](float frame) {
        load_scene(step, scene);
        settings.frame = frame;
        step.submit(settings);
        step.wait();
        return training::read_use(device(), step.tally(), scene.tree);
    };
    const training::LeafUse once = run_at(0.5f), twice = run_at(2);
    size_t reached = 0, weakly = 0, grown = 0;
    for (uint32_t leaf = 0; leaf < scene.tree.leaf_count; ++leaf) {
        EXPECT_EQ(once.frames[leaf], once.max_weight[leaf] >= 0.05f ? 0b011u : 0u);
        EXPECT_EQ(once.frames[leaf] & ~twice.frames[leaf], 0u);
        EXPECT_GE(twice.max_weight[leaf], once.max_weight[leaf]);
        EXPECT_GE(twice.opacity_sensitivity[leaf], once.opacity_sensitivity[leaf]);
        EXPECT_TRUE(once.max_weight[leaf] > 0 || once.opacity_sensitivity[leaf] == 0);
        reached += once.frames[leaf] != 0 ? 1 : 0;
        weakly += once.max_weight[leaf] > 0 && once.frames[leaf] == 0 ? 1 : 0;
        grown +=
            twice.frames[leaf] == 0b111u && twice.opacity_sensitivity[leaf] > once.opacity_sensitivity[leaf] ? 1 : 0;
    }
    EXPECT_GT(reached, 20u);
    EXPECT_GT(weakly, 5u);
    EXPECT_GT(grown, 10u);
}

// Steps that are far too large empty many leaves, unless densities have a bound.
TEST_F(AdamTest, DensitiesStayAboveTheirBound) {
    Scene scene = random_scene({.tree = {.seed = 57, .leaves = 300, .bases = 3, .hh_degree = 1}});
    scene.tree.frames = 3;
    scene.tree.sigma_basis = scene.tree.gamma_basis = voctree::hat_basis(3, 3);
    constexpr float kBound = 0.01f;
    const auto depths_after_a_step = [&](float bound) {
        training::TrainingStep step(device(), scene.tree, 2, static_cast<uint32_t>(scene.tiles.size()));
        load_scene(step, scene);
        training::StepSettings settings = settings_of(scene);
        settings.frame = 1;
        settings.rates.sigma = 100;
        settings.adam.least_depth = bound;
        step.submit(settings);
        EXPECT_GT(step.wait().touched, 50u);
        voctree::VOctree after = scene.tree;
        step.download(after);
        return after;
    };
    const voctree::VOctree free = depths_after_a_step(0), bounded = depths_after_a_step(kBound);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(scene.tree);
    size_t emptied = 0;
    for (uint32_t leaf = 0; leaf < scene.tree.leaf_count; ++leaf) {
        const float before = scene.tree.leaf(leaf)[1],
                    bound = kBound * std::exp2(static_cast<float>(positions[leaf].depth)) / scene.tree.box_size.x;
        EXPECT_EQ(bounded.leaf(leaf)[0], scene.tree.leaf(leaf)[0]) << "another frame";
        EXPECT_EQ(bounded.leaf(leaf)[2], scene.tree.leaf(leaf)[2]) << "another frame";
        if (before <= 0 || free.leaf(leaf)[1] == before) {
            EXPECT_EQ(bounded.leaf(leaf)[1], before) << "no ray touched it";
        } else if (free.leaf(leaf)[1] < bound) {
            EXPECT_FLOAT_EQ(bounded.leaf(leaf)[1], bound);
            ++emptied;
        } else {
            EXPECT_NEAR(bounded.leaf(leaf)[1], free.leaf(leaf)[1], 1e-3f * free.leaf(leaf)[1]);
        }
    }
    EXPECT_GT(emptied, 20u);
}

TEST_F(AdamTest, RowsStayWhereTheyAreNotLearnt) {
    const Scene scene = random_scene({.tree = {.seed = 52, .leaves = 300, .bases = 5, .hh_degree = 1}});
    training::TrainingStep step(device(), scene.tree, 2, 7);
    load_scene(step, scene);
    training::StepSettings settings = settings_of(scene);
    settings.rates = {.sigma = 0.1f, .gamma = 0.1f, .colour = 0.1f, .detail = 0.1f, .sigma_rows = 1, .gamma_rows = 1};
    settings.learn_rows = false;
    step.submit(settings);
    step.wait();
    voctree::VOctree after = scene.tree;
    step.download(after);
    EXPECT_EQ(after.sigma_basis, scene.tree.sigma_basis);
    EXPECT_EQ(after.gamma_basis, scene.tree.gamma_basis);
    EXPECT_NE(after.weights, scene.tree.weights);
}

// A tree learns to look like the images of a random tree with the same leaves.
TEST_F(AdamTest, AHundredStepsLearnAFixedBatch) {
    Scene scene = random_scene({.tree = {.seed = 61, .node_levels = 1, .leaves = 30, .bases = 5, .hh_degree = 1}});
    training::TrainingStep teacher(device(), scene.tree, 2, 7);
    load_scene(teacher, scene);
    teacher.submit(settings_of(scene));
    teacher.wait();
    std::vector<glm::vec4> seen(scene.target.size());
    gpu::download(device(), teacher.rays().radiance, seen.data(), seen.size() * sizeof(glm::vec4));
    for (size_t i = 0; i < seen.size(); ++i)
        if (scene.target[i].a >= 0) scene.target[i] = seen[i];

    voctree::VOctree pupil = scene.tree;
    for (uint32_t leaf = 0; leaf < pupil.leaf_count; ++leaf)
        for (uint32_t i = 2 * pupil.bases; i < pupil.weights_per_leaf(); ++i) pupil.leaf(leaf)[i] = 0;  // grey
    training::TrainingStep step(device(), pupil, 2, 7);
    load_scene(step, scene);
    training::StepSettings settings = settings_of(scene);
    settings.rates = {
        .sigma = 0.05f, .gamma = 0.01f, .colour = 0.15f, .detail = 0.15f, .sigma_rows = 1e-3f, .gamma_rows = 1e-3f};
    double first = 0, last = 0;
    for (uint32_t i = 1; i <= 100; ++i) {
        settings.adam.step = i;
        step.submit(settings);
        const training::StepResult result = step.wait();
        last = result.total(settings.weights);
        if (i == 1) first = last;
    }
    EXPECT_GT(first, 1e-3);
    EXPECT_LT(last, first / 10);
}

}  // namespace
}  // namespace neuvv::test
