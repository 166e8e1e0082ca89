// The whole chain of adjoints, pixels → samples → slice → w^σ, w^γ, w^HH, A, B, against central differences of the
// reference in double precision.
#include "gradient/chain.h"

#include <gtest/gtest.h>

#include "gradient/agreement.h"
#include "support/gpu_test.h"
#include "training/step/direct_step.h"

namespace neuvv::test {
namespace {

constexpr size_t kPicks = 30;

// Weights of a leaf that belong together, by their indices in the leaf.
struct Group {
    std::string name;
    std::vector<uint32_t> weights;
};

std::vector<Group> groups_of(const voctree::VOctree& tree) {
    std::vector<Group> groups = {{"w sigma", {}}, {"w gamma", {}}};
    for (uint32_t l = 0; l <= tree.hh_degree; ++l) groups.push_back({"w HH, l = " + std::to_string(l), {}});
    for (uint32_t c = 0; c < tree.bases; ++c) {
        groups[0].weights.push_back(c);
        groups[1].weights.push_back(tree.bases + c);
    }
    for (uint32_t channel = 0; channel < 3; ++channel) {
        uint32_t weight = 2 * tree.bases + channel * hh_count(tree.hh_degree);
        for (uint32_t n = 0; n <= tree.hh_degree; ++n)
            for (uint32_t l = 0; l <= n; ++l)
                for (uint32_t m = 0; m < 2 * l + 1; ++m) groups[2 + l].weights.push_back(weight++);
    }
    return groups;
}

void expect_weight_gradients(const Scene& scene, Chain& chain, const Gradients& gradients) {
    Random random(7);
    const std::vector<uint32_t> seen = chain.seen_leaves();
    ASSERT_GT(seen.size(), 10u);
    for (const Group& group : groups_of(scene.tree)) {
        std::vector<GradientPair> pairs;
        for (size_t i = 0; i < kPicks; ++i) {
            const uint32_t leaf = seen[random.below(seen.size())];
            const uint32_t weight = group.weights[random.below(group.weights.size())];
            const float found = gradients.weights[index_in_planes(scene.tree, leaf, weight)];
            pairs.push_back({static_cast<double>(found), chain.by_weight(leaf, weight)});
        }
        // With degree 0, colour does not depend on the hyper angle: H_000 is constant.
        if (group.name == "w gamma" && scene.tree.hh_degree == 0) {
            for (const GradientPair& pair : pairs) EXPECT_EQ(pair.found, 0);
            continue;
        }
        expect_gradients(group.name, pairs);
    }
}

// Compares all elements of the two rows between which the frame lies; gradients of the others must be 0.
void expect_row_gradients(const Scene& scene, Chain& chain, const Gradients& gradients) {
    const uint32_t bases = scene.tree.bases;
    const auto first = static_cast<uint32_t>(scene.frame);
    for (const bool of_gamma : {false, true}) {
        std::vector<GradientPair> pairs;
        for (size_t i = 0; i < size_t{scene.tree.frames} * bases; ++i) {
            const auto found =
                static_cast<double>(gradients.rows[i + (of_gamma ? size_t{scene.tree.frames} * bases : 0)]);
            const bool moves = i / bases == first || i / bases == first + 1;
            if (moves && !(of_gamma && scene.tree.hh_degree == 0))
                pairs.push_back({found, chain.by_row(of_gamma, i)});
            else
                EXPECT_EQ(found, 0) << "row " << i / bases;
        }
        if (!pairs.empty()) expect_gradients(of_gamma ? "B" : "A", pairs);
    }
}

// Expects gradients of exactly 0 for leaves without density and for leaves that no ray saw.
void expect_nothing_elsewhere(const Scene& scene, const Chain& chain, const Gradients& gradients) {
    std::vector<bool> seen(scene.tree.leaf_count);
    for (const uint32_t leaf : chain.seen_leaves()) seen[leaf] = true;
    size_t unseen = 0;
    for (uint32_t leaf = 0; leaf < scene.tree.leaf_count; ++leaf) {
        if (seen[leaf]) continue;
        ++unseen;
        for (uint32_t weight = 0; weight < scene.tree.weights_per_leaf(); ++weight)
            ASSERT_EQ(gradients.weights[index_in_planes(scene.tree, leaf, weight)], 0.0f) << leaf;
    }
    EXPECT_GT(unseen, 0u);
}

void expect_chain(const gpu::Device& device, const Scene& scene) {
    training::TrainingStep step(device, scene.tree, 2, static_cast<uint32_t>(scene.tiles.size()));
    const Gradients gradients = emitted_gradients(device, step, scene);
    Chain chain(scene);
    expect_weight_gradients(scene, chain, gradients);
    expect_row_gradients(scene, chain, gradients);
    expect_nothing_elsewhere(scene, chain, gradients);
}

using ChainGradient = GpuTest;

TEST_F(ChainGradient, IsThatOfTheReferenceForEveryDegree) {
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        SCOPED_TRACE("degree " + std::to_string(degree));
        const uint32_t bases = 3 + 2 * degree;  // 3, 5, 7, 9: never a multiple of four
        expect_chain(device(),
                     random_scene({.tree = {.seed = 11 + degree, .leaves = 300, .bases = bases, .hh_degree = degree}}));
    }
}

TEST_F(ChainGradient, IsThatOfTheReferenceWhereRaysEndEarly) {
    const Scene scene = random_scene({.tree = {.seed = 21, .node_levels = 3, .leaves = 700, .bases = 5, .hh_degree = 2},
                                      .density = 20,
                                      .stop = 1.0f / 256});
    EXPECT_GT(Chain(scene).rays_ended_early(), 20u);
    expect_chain(device(), scene);
}

TEST_F(ChainGradient, SmoothnessIsThatOfTheReference) {
    for (const uint32_t levels : {2u, 3u, 5u}) {
        SCOPED_TRACE("levels " + std::to_string(levels));
        Scene scene = random_scene(
            {.tree = {.seed = 70 + levels, .node_levels = levels, .leaves = 700, .bases = 5, .hh_degree = 1}});
        scene.weights.grad = 0;        // |e| has kinks, where central differences are wrong
        scene.weights.smoothness = 2;  // large enough to matter beside the losses of rays
        expect_chain(device(), scene);
    }
}

TEST_F(ChainGradient, LossAndCountAreThoseOfTheReference) {
    const Scene scene = random_scene({.tree = {.seed = 31, .leaves = 300, .bases = 5, .hh_degree = 2}});
    training::TrainingStep step(device(), scene.tree, 2, static_cast<uint32_t>(scene.tiles.size()));
    load_scene(step, scene);
    step.submit(settings_of(scene));
    const training::StepResult result = step.wait();
    const auto inside = std::count_if(scene.target.begin(), scene.target.end(), [](glm::vec4 t) { return t.a >= 0; });
    EXPECT_EQ(result.pixels, static_cast<uint64_t>(inside));
    EXPECT_LT(result.pixels, scene.target.size());
    const double loss =
        (result.rgb_loss + static_cast<double>(scene.weights.grad) * result.grad_loss) * static_cast<double>(inside);
    Scene without = scene;
    without.weights.point = 0;  // the device does not report the point loss
    const double truth = Chain(without).loss();
    EXPECT_NEAR(loss, truth, 1e-5 * truth);
    EXPECT_EQ(result.overflow, 0u);
}

// What a step leaves in the buffers must not change the next step.
TEST_F(ChainGradient, ASecondStepStartsClean) {
    const Scene scene = random_scene({.tree = {.seed = 41, .leaves = 300, .bases = 5, .hh_degree = 2}});
    const Scene other = with_tiles(scene, 12, 5, 5);
    training::TrainingStep used(device(), scene.tree, 2, 7), fresh(device(), scene.tree, 2, 7);
    emitted_gradients(device(), used, scene);
    const Gradients again = emitted_gradients(device(), used, other), truth = emitted_gradients(device(), fresh, other);
    ASSERT_EQ(again.weights.size(), truth.weights.size());
    size_t touched = 0;
    float largest = 0;
    for (const float value : truth.weights) largest = std::max(largest, std::abs(value));
    for (size_t i = 0; i < truth.weights.size(); ++i) {
        touched += truth.weights[i] != 0;
        ASSERT_NEAR(again.weights[i], truth.weights[i], 1e-5f * largest);  // the order of atomic additions varies
    }
    EXPECT_GT(touched, 1000u);
    for (size_t i = 0; i < truth.rows.size(); ++i) ASSERT_NEAR(again.rows[i], truth.rows[i], 1e-4f * largest);
}

// Steps at the same frame update the slice to the moved weights, instead of slicing again.
TEST_F(ChainGradient, AKeptSliceIsThatOfTheMovedWeights) {
    const Scene scene = random_scene({.tree = {.seed = 61, .leaves = 300, .bases = 5, .hh_degree = 2}});
    const auto tiles = static_cast<uint32_t>(scene.tiles.size());
    training::TrainingStep kept(device(), scene.tree, 2, tiles);
    load_scene(kept, scene);
    training::StepSettings settings = settings_of(scene);
    settings.learn_rows = false;
    settings.rates = {.sigma = 0.5f, .gamma = 0.1f, .colour = 0.3f, .detail = 0.2f};
    for (settings.adam.step = 1; settings.adam.step <= 3; ++settings.adam.step) {
        kept.submit(settings);
        kept.wait();
    }
    voctree::VOctree moved = scene.tree;
    kept.download(moved);
    training::TrainingStep fresh(device(), moved, 2, tiles);
    const Gradients found = emitted_gradients(device(), kept, scene), truth = emitted_gradients(device(), fresh, scene),
                    before = emitted_gradients(
                        device(), *std::make_unique<training::TrainingStep>(device(), scene.tree, 2, tiles), scene);
    float largest = 0, moved_by = 0;
    for (size_t i = 0; i < truth.weights.size(); ++i) {
        largest = std::max(largest, std::abs(truth.weights[i]));
        moved_by = std::max(moved_by, std::abs(truth.weights[i] - before.weights[i]));
    }
    EXPECT_GT(moved_by, 0.1f * largest);
    for (size_t i = 0; i < truth.weights.size(); ++i)
        ASSERT_NEAR(found.weights[i], truth.weights[i], 1e-5f * largest) << i;
}

TEST_F(ChainGradient, TheDirectStepsIsThatOfTheReferenceWithBothAtomics) {
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        SCOPED_TRACE("degree " + std::to_string(degree));
        const Scene scene =
            random_scene({.tree = {.seed = 51 + degree, .leaves = 300, .bases = 3 + 2 * degree, .hh_degree = degree}});
        Chain chain(scene);
        for (const training::AtomicAdd atomics :
             {training::best_atomic_add(device()), training::AtomicAdd::kCompareAndSwap}) {
            training::DirectStep step(device(), scene.tree, 2, static_cast<uint32_t>(scene.tiles.size()), atomics);
            load_scene(step, scene);
            step.run(settings_of(scene));
            const size_t floats = step.gradients().bytes / sizeof(float);
            const Gradients gradients{download_floats(device(), step.gradients(), floats), {}};
            expect_weight_gradients(scene, chain, gradients);
            expect_nothing_elsewhere(scene, chain, gradients);
        }
    }
}

// The comparison must notice a wrong derivative.
TEST(GradientComparison, NoticesOnePartInFiveHundred) {
    const std::vector<GradientPair> right = {{1, 1}, {-0.5, -0.5}, {1e-7, 0}, {2e-4, 2e-4}};
    EXPECT_LE(gradient_disagreement(right), kGradientTolerance);
    for (size_t i = 0; i < right.size(); ++i) {
        std::vector<GradientPair> wrong = right;
        wrong[i].found = 1.002 * wrong[i].truth + 1e-5 * (i == 2);
        EXPECT_EQ(gradient_disagreement(wrong) > kGradientTolerance, i != 3) << i;
        wrong[i].found = NAN;
        EXPECT_GT(gradient_disagreement(wrong), kGradientTolerance);
    }
}

}  // namespace
}  // namespace neuvv::test
