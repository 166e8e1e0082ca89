// Ψ on the device against the reference in double precision: forwards, backwards, and moved by Adam.
#include "training/psi/psi.h"

#include <gtest/gtest.h>

#include "gradient/agreement.h"
#include "gradient/scene.h"
#include "reference/adam.h"
#include "reference/loss.h"
#include "reference/psi.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

constexpr training::PsiSampling kSampling{6, 5};

struct PsiOptions {
    uint64_t seed = 5;
    uint32_t width = 32, layers = 2, hh_degree = 1;
};

// A network unlike one before training: every parameter is random, and σ is positive in about half of the box.
training::PsiNetwork random_psi(const Scene& scene, const PsiOptions& options) {
    const training::PsiShape shape{.frequencies = 4,
                                   .width = options.width,
                                   .layers = options.layers,
                                   .bases = scene.tree.bases,
                                   .hh_degree = options.hh_degree,
                                   .frames = scene.tree.frames};
    training::PsiNetwork network = training::initial_psi(shape, scene.tree.box_min, scene.tree.box_size, options.seed);
    network.density = 3;
    Random random(options.seed + 1);
    for (uint32_t i = shape.output_offset(); i < shape.parameter_count(); ++i)
        network.parameters[i] = static_cast<float>((i < shape.sigma_rows_offset() ? 0.4 : 0.6) * random.bell());
    for (uint32_t layer = 0; layer < shape.layers; ++layer) {
        float* bias = &network.parameters[psi_layer_offset(layer + 1, shape.inputs(), shape.width) - shape.width];
        for (uint32_t o = 0; o < shape.width; ++o) bias[o] = static_cast<float>(0.3 * random.bell());
    }
    return network;
}

// The device's parameters in the reference's form, without the features that only fill up the encoding.
reference::Psi reference_of(const training::PsiNetwork& network) {
    const training::PsiShape& shape = network.shape;
    const auto layer_at = [&](uint32_t first, size_t inputs, size_t padded, size_t outputs) {
        reference::PsiLayer layer{inputs, outputs, {}};
        const auto begin = network.parameters.begin() + first;
        const auto rows = [&](size_t from, size_t to) {
            layer.numbers.insert(layer.numbers.end(), begin + static_cast<std::ptrdiff_t>(from * outputs),
                                 begin + static_cast<std::ptrdiff_t>(to * outputs));
        };
        rows(0, inputs);
        rows(padded, padded + 1);
        return layer;
    };
    reference::Psi psi{shape.frequencies, shape.bases, shape.hh_degree, static_cast<double>(network.density), {}, {}};
    for (uint32_t layer = 0; layer < shape.layers; ++layer)
        psi.hidden.push_back(layer_at(psi_layer_offset(layer, shape.inputs(), shape.width),
                                      layer == 0 ? 3 + 6 * shape.frequencies : shape.width,
                                      layer == 0 ? shape.inputs() : shape.width, shape.width));
    psi.output = layer_at(shape.output_offset(), shape.width, shape.width, shape.outputs());
    return psi;
}

training::PsiStepSettings settings_for(const Scene& scene) {
    training::PsiStepSettings settings;
    settings.frame = scene.frame;
    settings.tiles = static_cast<uint32_t>(scene.tiles.size());
    settings.seed = 77;
    settings.weights = scene.weights;
    settings.revival = -1;  // relu's own derivative
    settings.adam.emit_only = true;
    return settings;
}

// A step of the reference with the samples that the device took.
class PsiChain {
  public:
    PsiChain(const Scene& scene, const training::PsiNetwork& network, std::vector<glm::vec4> points)
        : psi(reference_of(network)), scene_(scene), points_(std::move(points)) {
        const auto rows = reference::frame_rows(static_cast<double>(scene.frame), network.shape.frames);
        const auto basis = [&](uint32_t first) {
            const auto at = network.parameters.begin() + first;
            return reference::basis_row({at, at + network.shape.frames * network.shape.bases}, network.shape.bases,
                                        rows);
        };
        row_a = basis(network.shape.sigma_rows_offset());
        row_b = basis(network.shape.gamma_rows_offset());
        for (const Tile& tile : scene.tiles)
            for (uint32_t lane = 0; lane < kTilePixels; ++lane)
                directions_.push_back(ray_of(scene, tile, lane).direction);
    }

    reference::PsiSample sample(size_t i) const {
        return reference::psi_sample(psi, row_a, row_b, glm::dvec3(points_[i]), directions_[ray_of_sample(i)]);
    }
    double loss() const {
        double sum = 0;
        for (size_t tile = 0; tile < scene_.tiles.size(); ++tile)
            sum += reference::patch_loss(patch(tile), 1).total(static_cast<double>(scene_.weights.grad));
        return sum;
    }
    // `revival` in 1/m.
    reference::PsiGradient gradient(double revival) const {
        reference::PsiGradient sum = reference::psi_gradient_begin(psi);
        for (size_t tile = 0; tile < scene_.tiles.size(); ++tile) {
            const auto d_pixels =
                reference::patch_loss_adjoint(patch(tile), static_cast<double>(scene_.weights.grad), 1);
            for (size_t lane = 0; lane < kTilePixels; ++lane) add_ray(tile, lane, d_pixels[lane], revival, sum);
        }
        return sum;
    }

    reference::Psi psi;
    std::vector<double> row_a, row_b;

  private:
    static size_t ray_of_sample(size_t i) { return i / (kTilePixels * kSampling.fine) * kTilePixels + i % kTilePixels; }
    size_t sample_of(size_t tile, size_t lane, size_t i) const {
        return (tile * kSampling.fine + i) * kTilePixels + lane;
    }
    std::vector<reference::Sample> samples(size_t tile, size_t lane) const {
        std::vector<reference::Sample> result;
        for (size_t i = 0; i < kSampling.fine; ++i) {
            const size_t at = sample_of(tile, lane, i);
            const reference::PsiSample value = sample(at);
            result.push_back({value.sigma, value.colour, static_cast<double>(points_[at].w), 0});
        }
        return result;
    }
    reference::Patch patch(size_t tile) const {
        reference::Patch patch;
        for (size_t lane = 0; lane < kTilePixels; ++lane) {
            const size_t ray = tile * kTilePixels + lane;
            const glm::dvec4 truth(scene_.target[ray]);
            patch[lane].inside = truth.a >= 0;
            if (!patch[lane].inside) continue;
            const reference::RayResult seen = reference::composite(samples(tile, lane));
            patch[lane].colour = seen.colour;
            patch[lane].alpha = seen.alpha;
            patch[lane].true_colour = glm::dvec3(truth);
            patch[lane].true_alpha = truth.a;
            patch[lane].background = glm::dvec3(scene_.background[ray]);
        }
        return patch;
    }
    void add_ray(size_t tile, size_t lane, const reference::PixelGradient& d, double revival,
                 reference::PsiGradient& sum) const {
        const auto by_sample = reference::composite_adjoint(samples(tile, lane), d.colour, d.alpha);
        for (size_t i = 0; i < kSampling.fine; ++i) {
            const size_t at = sample_of(tile, lane, i);
            reference::psi_sample_adjoint(psi, row_a, row_b, glm::dvec3(points_[at]), directions_[ray_of_sample(at)],
                                          by_sample[i].sigma, by_sample[i].colour, sum, revival);
        }
    }

    const Scene& scene_;
    std::vector<glm::vec4> points_;
    std::vector<glm::dvec3> directions_;
};

double central_difference(double& parameter, const PsiChain& chain) {
    const double before = parameter, nudge = 1e-6;
    parameter = before + nudge;
    const double above = chain.loss();
    parameter = before - nudge;
    const double below = chain.loss();
    parameter = before;
    return (above - below) / (2 * nudge);
}

// Parameters that belong together: their indices on the device, and where they are in the reference.
struct PsiGroup {
    std::string name;
    std::vector<std::pair<uint32_t, double*>> numbers;
};

std::vector<PsiGroup> groups_of(const training::PsiShape& shape, PsiChain& chain) {
    std::vector<PsiGroup> groups;
    for (uint32_t layer = 0; layer < shape.layers; ++layer) {
        const uint32_t first = psi_layer_offset(layer, shape.inputs(), shape.width);
        reference::PsiLayer& truth = chain.psi.hidden[layer];
        PsiGroup weights{"weights of layer " + std::to_string(layer), {}},
            bias{"bias of layer " + std::to_string(layer), {}};
        const auto inputs = static_cast<uint32_t>(truth.inputs);
        for (uint32_t i = 0; i < inputs * shape.width; ++i) weights.numbers.emplace_back(first + i, &truth.numbers[i]);
        for (uint32_t o = 0; o < shape.width; ++o)
            bias.numbers.emplace_back(psi_layer_offset(layer + 1, shape.inputs(), shape.width) - shape.width + o,
                                      &truth.numbers[inputs * shape.width + o]);
        groups.push_back(weights);
        groups.push_back(bias);
    }
    PsiGroup sigma{"output w sigma", {}}, gamma{"output w gamma", {}}, hh{"output w HH", {}}, bias{"output bias", {}};
    for (uint32_t i = 0; i < (shape.width + 1) * shape.outputs(); ++i) {
        const uint32_t column = i % shape.outputs();
        PsiGroup& group = i >= shape.width * shape.outputs() ? bias
                          : column < shape.bases             ? sigma
                          : column < 2 * shape.bases         ? gamma
                                                             : hh;
        group.numbers.emplace_back(shape.output_offset() + i, &chain.psi.output.numbers[i]);
    }
    groups.insert(groups.end(), {sigma, gamma, hh, bias});
    return groups;
}

using PsiTest = GpuTest;

Scene psi_scene(uint64_t seed, uint32_t degree) {
    const Scene scene = random_scene({.tree = {.seed = seed, .leaves = 20, .bases = 5, .hh_degree = degree}});
    return with_tiles(scene, 3, 2, seed);
}

// The same as psi_random.glsl.
uint32_t pcg(uint32_t value) {
    const uint32_t state = value * 747796405u + 2891336453u;
    const uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return word >> 22u ^ word;
}
double random_at(uint32_t seed, uint32_t ray, uint32_t i) {
    return (pcg(pcg(pcg(seed) + ray) + i) >> 8u) / 16777216.0;
}

// The distances between which the ray is inside the box, computed independently of the shader.
std::pair<double, double> box_range(const Scene& scene, const reference::Ray& ray) {
    double enter = 0, leave = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = static_cast<double>(scene.tree.box_min[axis]),
                     high = low + static_cast<double>(scene.tree.box_size[axis]);
        const double a = (low - ray.origin[axis]) / ray.direction[axis],
                     b = (high - ray.origin[axis]) / ray.direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave ? std::pair(enter, leave) : std::pair(0.0, 0.0);
}

// Both samplings of every ray, with the same random numbers: the fine samples gather where the coarse ones found σ.
TEST_F(PsiTest, SamplesStandWhereTheReferencePutsThem) {
    const Scene scene = psi_scene(41, 1);
    const training::PsiNetwork network = random_psi(scene, {});
    training::PsiStep step(device(), network, kSampling, 2, 2);
    load_scene(step, scene);
    const training::PsiStepSettings settings = settings_for(scene);
    step.submit(settings);
    step.wait();
    const std::vector<glm::vec4> points = step.points();
    const PsiChain chain(scene, network, points);
    const glm::dvec3 centre(network.centre());
    const auto scale = static_cast<double>(network.scale());
    size_t hits = 0, uneven = 0;
    for (uint32_t r = 0; r < 2 * kTilePixels; ++r) {
        if (scene.target[r].a < 0) continue;
        const reference::Ray ray = ray_of(scene, scene.tiles[r / kTilePixels], r % kTilePixels);
        const auto [enter, leave] = box_range(scene, ray);
        const auto position = [&](double t) { return (ray.origin + t * ray.direction - centre) * scale; };
        const double stride = (leave - enter) / kSampling.coarse;
        std::vector<double> sigmas;
        for (uint32_t i = 0; i < kSampling.coarse; ++i)
            sigmas.push_back(reference::psi_sample(chain.psi, chain.row_a, chain.row_b,
                                                   position(enter + (i + random_at(77, r, i)) * stride), ray.direction)
                                 .sigma);
        const auto edges = reference::importance_edges(sigmas, enter, leave, kSampling.fine, 0.2);
        for (uint32_t i = 0; i < kSampling.fine; ++i) {
            const glm::vec4 found = points[(r / kTilePixels * kSampling.fine + i) * kTilePixels + r % kTilePixels];
            const double length = edges[i + 1] - edges[i];
            const double t = edges[i] + length * random_at(77, r, kSampling.coarse + i);
            ASSERT_NEAR(static_cast<double>(found.w), length, 2e-4) << r << ' ' << i;
            const double off = leave > enter ? glm::length(glm::dvec3(found) - position(t)) : 0;
            ASSERT_LT(off, 2e-4 * scale) << r << ' ' << i;
            uneven += std::abs(length - (leave - enter) / kSampling.fine) > 0.05 * (leave - enter) ? 1 : 0;
        }
        hits += leave > enter ? 1 : 0;
    }
    EXPECT_GT(hits, 50u);
    EXPECT_GT(uneven, 50u);
}

class PsiShapes : public GpuTest, public ::testing::WithParamInterface<PsiOptions> {};

TEST_P(PsiShapes, ForwardIsTheReference) {
    const Scene scene = psi_scene(42, GetParam().hh_degree);
    const training::PsiNetwork network = random_psi(scene, GetParam());
    training::PsiStep step(device(), network, kSampling, 2, 2);
    load_scene(step, scene);
    step.submit(settings_for(scene));
    const training::StepResult result = step.wait();
    const PsiChain chain(scene, network, step.points());
    const std::vector<glm::vec4> values = step.values();
    double worst_sigma = 0, worst_colour = 0, wrong = 0, whole = 0, largest = 0;
    size_t dense = 0;
    for (size_t i = 0; i < values.size(); ++i) {
        if (scene.target[i / (kTilePixels * kSampling.fine) * kTilePixels + i % kTilePixels].a < 0) continue;
        const reference::PsiSample truth = chain.sample(i);
        const glm::dvec4 found(values[i]);
        largest = std::max(largest, truth.sigma);
        worst_sigma = std::max(worst_sigma, std::abs(found.x - truth.sigma));
        const glm::dvec3 off = glm::abs(glm::dvec3(found.y, found.z, found.w) - truth.colour);
        worst_colour = std::max({worst_colour, off.x, off.y, off.z});
        wrong += (found.x - truth.sigma) * (found.x - truth.sigma) + glm::dot(off, off);
        whole += truth.sigma * truth.sigma + glm::dot(truth.colour, truth.colour);
        dense += truth.sigma > 0 ? 1 : 0;
    }
    EXPECT_GT(dense, values.size() / 10);
    EXPECT_LT(worst_sigma, 1e-4 * largest);
    EXPECT_LT(worst_colour, 1e-4);
    EXPECT_LT(wrong / whole, 1e-9);
    const double pixels = static_cast<double>(result.pixels);
    EXPECT_NEAR(pixels * (result.rgb_loss + 0.1 * result.grad_loss), chain.loss(), 1e-4 * chain.loss());
}

TEST_P(PsiShapes, GradientsAreTheDifferencesOfTheReference) {
    const Scene scene = psi_scene(43, GetParam().hh_degree);
    const training::PsiNetwork network = random_psi(scene, GetParam());
    training::PsiStep step(device(), network, kSampling, 2, 2);
    load_scene(step, scene);
    step.submit(settings_for(scene));
    step.wait();
    const std::vector<float> found = step.gradients();
    PsiChain chain(scene, network, step.points());
    Random random(9);
    for (const PsiGroup& group : groups_of(network.shape, chain)) {
        std::vector<GradientPair> pairs;
        for (size_t i = 0; i < 12; ++i) {
            const auto [at, number] = group.numbers[random.below(group.numbers.size())];
            pairs.push_back({static_cast<double>(found[at]), central_difference(*number, chain)});
        }
        if (group.name == "output w gamma" && network.shape.hh_degree == 0) {
            for (const GradientPair& pair : pairs) EXPECT_EQ(pair.found, 0);
            continue;
        }
        SCOPED_TRACE(group.name);
        EXPECT_LE(gradient_disagreement(pairs), kGradientTolerance);
    }
}

// The gradients of all parameters, rows included, against the adjoint of the reference; those of rows of other times
// must be exactly 0. As in training, gradients pass relu where σ = 0, too, which central differences could not check.
TEST_P(PsiShapes, GradientsAreTheAdjointOfTheReference) {
    const Scene scene = psi_scene(44, GetParam().hh_degree);
    const training::PsiNetwork network = random_psi(scene, GetParam());
    const training::PsiShape& shape = network.shape;
    training::PsiStep step(device(), network, kSampling, 2, 2);
    load_scene(step, scene);
    training::PsiStepSettings settings = settings_for(scene);
    settings.revival = 0.3f;
    step.submit(settings);
    step.wait();
    const std::vector<float> found = step.gradients();
    const PsiChain chain(scene, network, step.points());
    const reference::PsiGradient truth = chain.gradient(static_cast<double>(settings.revival * network.density));
    const auto compare = [&](const char* name, uint32_t first, const std::vector<double>& numbers, double share) {
        double wrong = 0, whole = 0, largest = 0, worst = 0;
        for (size_t i = 0; i < numbers.size(); ++i) {
            const double off = static_cast<double>(found[first + i]) - share * numbers[i];
            wrong += off * off;
            whole += share * numbers[i] * share * numbers[i];
            worst = std::max(worst, std::abs(off));
            largest = std::max(largest, std::abs(share * numbers[i]));
        }
        EXPECT_GT(largest, 1e-4) << name;
        EXPECT_LT(worst, 1e-4 * largest) << name;
        EXPECT_LT(wrong, 1e-8 * whole) << name;
    };
    const uint32_t real = 3 + 6 * shape.frequencies;
    std::vector<double> first_layer = truth.network.hidden[0].numbers;
    first_layer.insert(first_layer.end() - shape.width, (shape.inputs() - real) * shape.width, 0.0);
    compare("layer 0", 0, first_layer, 1);
    for (uint32_t layer = 1; layer < shape.layers; ++layer)
        compare("hidden layer", psi_layer_offset(layer, shape.inputs(), shape.width),
                truth.network.hidden[layer].numbers, 1);
    compare("output", shape.output_offset(), truth.network.output.numbers, 1);
    const double blend = static_cast<double>(scene.frame) - 1;
    compare("A before", shape.sigma_rows_offset() + shape.bases, truth.row_a, 1 - blend);
    compare("A after", shape.sigma_rows_offset() + 2 * shape.bases, truth.row_a, blend);
    if (shape.hh_degree > 0) {
        compare("B before", shape.gamma_rows_offset() + shape.bases, truth.row_b, 1 - blend);
        compare("B after", shape.gamma_rows_offset() + 2 * shape.bases, truth.row_b, blend);
    }
    for (uint32_t i = shape.sigma_rows_offset(); i < shape.parameter_count(); ++i) {
        const uint32_t row = (i - shape.sigma_rows_offset()) % (shape.frames * shape.bases) / shape.bases;
        if (row == 1 || row == 2) continue;
        ASSERT_EQ(found[i], 0) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Psi, PsiShapes,
                         ::testing::Values(PsiOptions{5, 32, 2, 1}, PsiOptions{11, 64, 3, 2}, PsiOptions{7, 32, 1, 0},
                                           PsiOptions{8, 64, 2, 3}));

TEST_F(PsiTest, HiddenLayerAtAnyPlaces) {
    const Scene scene = psi_scene(45, 1);
    const training::PsiNetwork network = random_psi(scene, {});
    training::PsiStep step(device(), network, kSampling, 2, 1);  // too small for all positions at once
    std::vector<glm::vec3> positions;
    Random random(3);
    for (size_t i = 0; i < 1000; ++i)
        positions.push_back(network.box_min +
                            network.box_size * glm::vec3(random.uniform(), random.uniform(), random.uniform()));
    const std::vector<float> found = step.hidden_at(positions);
    const reference::Psi psi = reference_of(network);
    double worst = 0, largest = 0;
    for (size_t i = 0; i < positions.size(); ++i) {
        const auto truth = reference::psi_hidden(
            psi, glm::dvec3(positions[i] - network.centre()) * static_cast<double>(network.scale()));
        for (size_t o = 0; o < truth.size(); ++o) {
            worst = std::max(worst, std::abs(truth[o] - static_cast<double>(found[i * truth.size() + o])));
            largest = std::max(largest, truth[o]);
        }
    }
    EXPECT_GT(largest, 0.5);
    EXPECT_LT(worst, 1e-5 * largest);
}

TEST_F(PsiTest, TheSameBatchGivesTheSameBits) {
    const Scene scene = psi_scene(46, 1);
    training::PsiStep step(device(), random_psi(scene, {}), kSampling, 2, 2);
    load_scene(step, scene);
    training::PsiStepSettings settings = settings_for(scene);
    const auto gradients = [&] {
        step.submit(settings);
        step.wait();
        return step.gradients();
    };
    const std::vector<float> once = gradients();
    EXPECT_EQ(gradients(), once);
    ++settings.seed;
    EXPECT_NE(gradients(), once);
}

TEST_F(PsiTest, AdamMovesWhatIsLearnt) {
    const Scene scene = psi_scene(47, 1);
    const training::PsiNetwork before = random_psi(scene, {});
    const training::PsiShape& shape = before.shape;
    training::PsiStep step(device(), before, kSampling, 2, 2);
    load_scene(step, scene);
    training::PsiStepSettings settings = settings_for(scene);
    settings.adam.emit_only = false;
    settings.rate = 3e-3f;
    settings.rows_rate = 1e-3f;
    step.submit(settings);
    step.wait();
    const std::vector<float> gradients = step.gradients(), after = step.network().parameters;
    size_t moved = 0;
    for (uint32_t i = 0; i < shape.parameter_count(); ++i) {
        if (i >= shape.head_offset() && i < shape.output_offset()) continue;
        const double rate = static_cast<double>(i < shape.sigma_rows_offset() ? settings.rate : settings.rows_rate);
        reference::AdamElement truth{before.parameters[i], 0, 0};
        reference::adam_update(
            truth, gradients[i], {rate, settings.adam.beta1, settings.adam.beta2, settings.adam.epsilon},
            reference::adam_bias(settings.adam.beta1, 1), reference::adam_bias(settings.adam.beta2, 1));
        ASSERT_NEAR(after[i], truth.weight, 1e-3 * rate + 1e-6 * std::abs(truth.weight)) << i;
        moved += after[i] != before.parameters[i] ? 1 : 0;
    }
    EXPECT_GT(moved, shape.parameter_count() / 2);
}

// Targets are a ramp of colours, opaque where rays are in the box for at least half a metre: the fog becomes matter.
TEST_F(PsiTest, LearnsAFixedBatch) {
    Scene scene = psi_scene(48, 1);
    for (uint32_t i = 0; i < scene.target.size(); ++i) {
        if (scene.target[i].a < 0) continue;
        const auto x = static_cast<float>(i % kTile) / 8;
        const auto [enter, leave] = box_range(scene, ray_of(scene, scene.tiles[i / kTilePixels], i % kTilePixels));
        scene.target[i] = glm::vec4(0.2f + 0.5f * x, 0.7f - 0.5f * x, 0.3f, leave - enter > 0.5 ? 1 : -1);
    }
    const training::PsiShape shape{.frequencies = 4, .width = 32, .layers = 2, .bases = 5, .hh_degree = 1, .frames = 5};
    training::PsiStep step(device(), training::initial_psi(shape, scene.tree.box_min, scene.tree.box_size, 1),
                           kSampling, 2, 2);
    load_scene(step, scene);
    training::PsiStepSettings settings = settings_for(scene);
    settings.adam.emit_only = false;
    settings.revival = 1;
    settings.rate = 1e-2f;
    settings.rows_rate = 1e-3f;
    double first = 0, last = 0;
    for (uint32_t i = 1; i <= 150; ++i) {
        settings.seed = i;
        settings.adam.step = i;
        step.submit(settings);
        last = step.wait().rgb_loss;
        if (i == 1) first = last;
    }
    EXPECT_GT(first, 0.05);
    EXPECT_LT(last, first / 20);
}

}  // namespace
}  // namespace neuvv::test
