// From Ψ to a tree: which leaves stay and which weights they have, for a network whose outputs are known; and training
// Ψ on captures of a sphere.
#include "training/psi/psi_tree.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "support/gpu_test.h"
#include "support/sphere_capture.h"
#include "training/evaluation/evaluate.h"
#include "training/run/train.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kLevels = 2;
const training::TreeShape kShape{.resolution = 32, .bases = 3, .hh_degree = 1};

const training::Dataset& psi_capture() {
    static const training::Dataset dataset = sphere_dataset({.cameras = 8, .frames = 3, .size = 40});
    return dataset;
}

const voctree::VOctree& hull() {
    static const voctree::VOctree tree = training::initial_tree(psi_capture(), kShape, kLevels);
    return tree;
}

// A network that is affine in x: in its coordinates, σ of frame t before relu is density · (x − 0.1 t) · A_tt.
// Everything else is constant.
training::PsiNetwork ramp_network() {
    const training::PsiShape shape{.frequencies = 2, .width = 32, .layers = 1, .bases = 3, .hh_degree = 1, .frames = 3};
    training::PsiNetwork network = training::initial_psi(shape, hull().box_min, hull().box_size, 1);
    network.density = 4;
    std::fill(network.parameters.begin(), network.parameters.end(), 0.0f);
    network.parameters[0] = 1;  // hidden number 0 is relu(x + 2), which is never at relu's kink
    network.parameters[shape.inputs() * shape.width] = 2;
    float* output = &network.parameters[shape.output_offset()];
    float* bias = output + size_t{shape.width} * shape.outputs();
    for (uint32_t t = 0; t < 3; ++t) {
        output[t] = 1;
        bias[t] = -2 - 0.1f * static_cast<float>(t);
        network.parameters[shape.sigma_rows_offset() + 3 * t + t] = 0.5f;
        network.parameters[shape.gamma_rows_offset() + 3 * t + t] = 0.25f;
    }
    for (uint32_t i = shape.bases; i < shape.outputs(); ++i) bias[i] = 0.01f * static_cast<float>(i);
    return network;
}

using PsiTreeTest = GpuTest;

TEST_F(PsiTreeTest, KeepsLeavesWithADenseCellAndGivesThemTheMean) {
    const training::PsiNetwork network = ramp_network();
    training::PsiStep psi(device(), network, {4, 4}, 1, 2);
    training::PsiSettings settings;
    settings.threshold = 0.3f;
    const voctree::VOctree tree = training::tree_from_psi(psi, hull(), kLevels, settings);
    EXPECT_EQ(voctree::defect_of(tree), "");
    EXPECT_EQ(tree.sigma_basis, (std::vector<float>{0.5f, 0, 0, 0, 0.5f, 0, 0, 0, 0.5f}));
    EXPECT_EQ(tree.gamma_basis, (std::vector<float>{0.25f, 0, 0, 0, 0.25f, 0, 0, 0, 0.25f}));

    const std::vector<voctree::LeafPosition> before = voctree::leaf_positions(hull()),
                                             after = voctree::leaf_positions(tree);
    const auto x_at = [&](const voctree::LeafPosition& position, double inside) {
        const double edge = static_cast<double>(tree.box_size.x) / std::exp2(position.depth);
        const double world = static_cast<double>(tree.box_min.x) + edge * (position.x + inside);
        return (world - static_cast<double>(network.centre().x)) * static_cast<double>(network.scale());
    };
    size_t kept = 0;
    for (const voctree::LeafPosition& position : before) {
        const double x = x_at(position, 0.875);  // the centre of the leaf's last finest cell along x
        double sum = 0;
        for (int t = 0; t < 3; ++t) sum += 0.5 * 4 * std::max(x - 0.1 * t, 0.0);
        const bool found = std::any_of(after.begin(), after.end(), [&](const voctree::LeafPosition& other) {
            return other.x == position.x && other.y == position.y && other.z == position.z &&
                   other.depth == position.depth;
        });
        EXPECT_EQ(found, sum >= 0.3) << position.x << ' ' << position.y << ' ' << position.z;
        kept += found ? 1 : 0;
    }
    EXPECT_EQ(kept, after.size());
    EXPECT_GT(kept, before.size() / 10);
    EXPECT_LT(kept, before.size() * 9 / 10);
    for (uint32_t leaf = 0; leaf < after.size(); ++leaf) {
        // Five standard deviations of the mean of 256 random points in the leaf.
        const double spread = 4 * (x_at(after[leaf], 1) - x_at(after[leaf], 0)) / std::sqrt(12.0 * 256);
        for (uint32_t t = 0; t < 3; ++t)
            ASSERT_NEAR(static_cast<double>(tree.leaf(leaf)[t]), 4 * (x_at(after[leaf], 0.5) - 0.1 * t), 5 * spread);
        for (uint32_t i = 3; i < tree.weights_per_leaf(); ++i)
            ASSERT_NEAR(tree.leaf(leaf)[i], 0.01f * static_cast<float>(i), 1e-6f);
    }
}

TEST_F(PsiTreeTest, ANetworkWithoutMatterSaysSo) {
    training::PsiNetwork network = ramp_network();
    network.density = 0;
    training::PsiStep psi(device(), network, {4, 4}, 1, 2);
    EXPECT_THROW(training::tree_from_psi(psi, hull(), kLevels, training::PsiSettings{}), RuntimeFailure);
}

training::PsiSettings small_psi_run(uint64_t steps) {
    training::PsiSettings settings;
    settings.steps = steps;
    settings.width = 32;
    settings.layers = 2;
    settings.frequencies = 4;
    settings.sampling = {8, 8};
    settings.tiles_per_step = 8;
    settings.points_per_leaf = 16;
    return settings;
}

// The network learns a sphere at rest. The tree that is made of it looks more like the sphere than the tree of a
// network that has not learnt.
TEST_F(PsiTreeTest, ARunBeginsWithWhatTheNetworkLearnt) {
    training::Dataset still = sphere_dataset({.cameras = 8, .frames = 1, .size = 40});
    const auto tree_after = [&](uint64_t steps, double& loss) {
        return training::psi_tree(device(), still, kShape, kLevels, small_psi_run(steps),
                                  [&](const training::PsiProgress& now) {
                                      loss = now.loss;
                                      return true;
                                  });
    };
    // The loss of a step says little, as a step sees few pixels: means of many steps are compared.
    double ignored = 0, early = 0, late = 0;
    tree_after(20, early);
    const voctree::VOctree fog = tree_after(1, ignored), learnt = tree_after(240, late);
    EXPECT_LT(late, 0.6 * early);
    EXPECT_EQ(voctree::defect_of(learnt), "");
    EXPECT_LE(learnt.leaf_count, fog.leaf_count);
    const double learnt_psnr = training::evaluate(device(), learnt, still, {.samples = 1}).mean.psnr;
    EXPECT_GT(learnt_psnr, training::evaluate(device(), fog, still, {.samples = 1}).mean.psnr + 2);

    // A training run can begin with this tree.
    training::TrainSettings settings;
    settings.steps = 30;
    settings.shape = kShape;
    settings.first_tree = &learnt;
    const TemporaryFolder folder;
    training::train(device(), still, settings, folder.path / "run.nvv",
                    [](const training::TrainProgress&) { return true; });
    EXPECT_GT(training::evaluate(device(), voctree::read_nvv(folder.path / "run.nvv"), still, {.samples = 1}).mean.psnr,
              learnt_psnr);
}

TEST_F(PsiTreeTest, EndsWhereToldTo) {
    uint64_t last = 0;
    training::psi_tree(device(), psi_capture(), kShape, kLevels, small_psi_run(1000000),
                       [&](const training::PsiProgress& now) {
                           last = now.step;
                           return false;
                       });
    EXPECT_GT(last, 0u);
    EXPECT_LT(last, 100000u);
}

}  // namespace
}  // namespace neuvv::test
