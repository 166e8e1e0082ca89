#include "training/psi/psi_tree.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/error.h"
#include "base/seconds.h"
#include "base/threads/parallel.h"
#include "training/step/batch.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

constexpr size_t kPointsAtOnce = size_t{1} << 20;
constexpr double kFirstRate = 3e-3, kLastRate = 3e-4, kRowsShare = 0.2;

// The output layer: y = W h + b, where h is the last hidden layer.
struct OutputLayer {
    uint32_t width, columns;
    const float* numbers;  // (width + 1) × columns

    void operator()(const float* hidden, double* y) const {
        const float* bias = numbers + size_t{width} * columns;
        std::copy(bias, bias + columns, y);
        for (uint32_t k = 0; k < width; ++k)
            for (uint32_t c = 0; c < columns; ++c)
                y[c] += static_cast<double>(hidden[k]) * static_cast<double>(numbers[size_t{k} * columns + c]);
    }
};

glm::vec3 leaf_corner(const voctree::VOctree& tree, const voctree::LeafPosition& position) {
    return tree.box_min +
           tree.box_size / static_cast<float>(1u << position.depth) * glm::vec3(position.x, position.y, position.z);
}

float leaf_edge(const voctree::VOctree& tree, const voctree::LeafPosition& position) {
    return tree.box_size.x / static_cast<float>(1u << position.depth);
}

// The centres of side³ cells in a leaf, in the world.
std::vector<glm::vec3> cell_centres_in(const voctree::VOctree& tree, const voctree::LeafPosition& position,
                                       uint32_t side) {
    std::vector<glm::vec3> centres;
    const float cell = leaf_edge(tree, position) / static_cast<float>(side);
    for (uint32_t i = 0; i < side * side * side; ++i)
        centres.push_back(leaf_corner(tree, position) +
                          cell * (glm::vec3(i % side, i / side % side, i / side / side) + 0.5f));
    return centres;
}

// Random points in a leaf, in the world.
std::vector<glm::vec3> random_points_in(const voctree::VOctree& tree, const voctree::LeafPosition& position,
                                        uint32_t count, std::mt19937_64& random) {
    std::vector<glm::vec3> positions(count);
    const auto uniform = [&] { return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53); };
    for (glm::vec3& at : positions) {
        const float x = uniform(), y = uniform(), z = uniform();
        at = leaf_corner(tree, position) + leaf_edge(tree, position) * glm::vec3(x, y, z);
    }
    return positions;
}

// Calls `use` with each leaf and the last hidden layer at its points, on all cores, for many leaves at a time.
template <typename PointsOf, typename Use>
void for_each_leaf(PsiStep& psi, size_t leaves, size_t points_per_leaf, const PointsOf& points_of, const Use& use) {
    const size_t at_once = std::max<size_t>(kPointsAtOnce / points_per_leaf, 1);
    const size_t stride = points_per_leaf * psi.shape().width;
    std::vector<glm::vec3> points;
    for (size_t first = 0; first < leaves; first += at_once) {
        const size_t count = std::min(at_once, leaves - first);
        points.clear();
        for (size_t i = 0; i < count; ++i) {
            const std::vector<glm::vec3> of_leaf = points_of(first + i);
            points.insert(points.end(), of_leaf.begin(), of_leaf.end());
        }
        const std::vector<float> hidden = psi.hidden_at(points);
        parallel_for(count, 16, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) use(first + i, &hidden[i * stride]);
        });
    }
}

// Σ_t relu(A_t·w^σ) with w^σ in 1/m.
double density_over_time(const PsiNetwork& network, const double* outputs) {
    const PsiShape& shape = network.shape;
    const float* basis = &network.parameters[shape.sigma_rows_offset()];
    double sum = 0;
    for (uint32_t t = 0; t < shape.frames; ++t) {
        double raw = 0;
        for (uint32_t c = 0; c < shape.bases; ++c)
            raw += static_cast<double>(basis[size_t{t} * shape.bases + c]) * outputs[c];
        sum += std::max(raw, 0.0);
    }
    return sum * static_cast<double>(network.density);
}

OutputLayer output_of(const PsiNetwork& network) {
    return {network.shape.width, network.shape.outputs(), &network.parameters[network.shape.output_offset()]};
}

// The hull's leaves in which at least one finest cell is dense.
std::vector<voctree::LeafPosition> dense_positions(PsiStep& psi, const PsiNetwork& network,
                                                   const voctree::VOctree& hull, uint32_t levels_above,
                                                   float threshold) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(hull);
    const OutputLayer output = output_of(network);
    const uint32_t side = 1u << levels_above, cells = side * side * side;
    std::vector<uint8_t> dense(positions.size());
    for_each_leaf(
        psi, positions.size(), cells, [&](size_t i) { return cell_centres_in(hull, positions[i], side); },
        [&](size_t i, const float* hidden) {
            std::vector<double> outputs(output.columns);
            for (uint32_t cell = 0; cell < cells && dense[i] == 0; ++cell) {
                output(hidden + size_t{cell} * output.width, outputs.data());
                dense[i] = density_over_time(network, outputs.data()) >= static_cast<double>(threshold) ? 1 : 0;
            }
        });
    std::vector<voctree::LeafPosition> kept;
    for (size_t i = 0; i < positions.size(); ++i)
        if (dense[i] != 0) kept.push_back(positions[i]);
    return kept;
}

// Sets each leaf's weights to the mean of the network's outputs over random points. As the output layer is linear, that
// is the output of the mean of the last hidden layer.
void set_mean_weights(PsiStep& psi, const PsiNetwork& network, voctree::VOctree& tree, const PsiSettings& settings) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const OutputLayer output = output_of(network);
    std::mt19937_64 random(settings.seed);
    const uint32_t count = settings.points_per_leaf;
    for_each_leaf(
        psi, positions.size(), count, [&](size_t i) { return random_points_in(tree, positions[i], count, random); },
        [&](size_t i, const float* hidden) {
            std::vector<float> mean(output.width);
            for (uint32_t k = 0; k < output.width; ++k) {
                double sum = 0;
                for (uint32_t point = 0; point < count; ++point)
                    sum += static_cast<double>(hidden[size_t{point} * output.width + k]);
                mean[k] = static_cast<float>(sum / count);
            }
            std::vector<double> outputs(output.columns);
            output(mean.data(), outputs.data());
            float* leaf = tree.leaf(static_cast<uint32_t>(i));
            for (uint32_t c = 0; c < output.columns; ++c)
                leaf[c] = static_cast<float>(outputs[c] * (c < tree.bases ? static_cast<double>(network.density) : 1));
        });
}

// How far the training of Ψ has come, and sums since the last report.
struct PsiRun {
    double began = seconds_now(), reported = began, pixels = 0, loss = 0, rgb = 0;
    uint64_t step = 0, steps = 0;

    double fraction(const PsiSettings& settings) const {
        const double share = settings.steps > 0 ? static_cast<double>(step) / static_cast<double>(settings.steps)
                                                : (seconds_now() - began) / (60 * settings.minutes);
        return std::min(share, 1.0);
    }
    void add(const StepResult& result, const LossWeights& weights) {
        pixels += static_cast<double>(result.pixels);
        rgb += result.rgb_loss;
        loss += result.total(weights);
        ++steps;
    }
    PsiProgress report(const PsiSettings& settings, const PsiStep& psi) {
        const double now = seconds_now(), share = std::max(fraction(settings), 1e-6), over = static_cast<double>(steps);
        PsiProgress progress{.elapsed_s = now - began, .step = step};
        progress.eta_s = progress.elapsed_s / share - progress.elapsed_s;
        progress.rays_per_s = pixels / std::max(now - reported, 1e-3);
        progress.loss = loss / std::max(over, 1.0);
        progress.psnr = -10 * std::log10(std::max(rgb / std::max(over, 1.0) / 3, 1e-10));
        progress.passes = psi.pass_times();
        reported = now;
        pixels = loss = rgb = 0;
        steps = 0;
        return progress;
    }
};

PsiStepSettings step_settings(const PsiSettings& settings, const PsiRun& run, const Batch& batch, uint32_t frames) {
    PsiStepSettings step;
    step.frame = static_cast<float>(frame_of_time(batch.time, frames));
    step.tiles = static_cast<uint32_t>(batch.tiles.size());
    step.seed = static_cast<uint32_t>(settings.seed * 0x9e3779b9u + run.step);
    const double rate = kFirstRate * std::pow(kLastRate / kFirstRate, run.fraction(settings));
    step.rate = static_cast<float>(rate);
    step.rows_rate = static_cast<float>(kRowsShare * rate);
    step.adam.step = static_cast<uint32_t>(run.step);
    return step;
}

void train_psi(PsiStep& psi, const Dataset& dataset, const PsiSettings& settings, const PsiCallback& callback) {
    // The network fills the whole box, so it has to learn where nothing is, too.
    BatchSampler sampler(dataset, settings.tiles_per_step, settings.seed, 1, kEveryTile);
    PsiRun run;
    Batch batch = sampler.next();
    bool go_on = true;
    while (go_on && run.fraction(settings) < 1) {
        load_batch(dataset, batch, psi.rays(), psi.batch());
        ++run.step;
        const PsiStepSettings step = step_settings(settings, run, batch, psi.shape().frames);
        psi.submit(step);
        batch = sampler.next();
        const StepResult result = psi.wait();
        if (!std::isfinite(result.rgb_loss))
            throw RuntimeFailure("training of Ψ diverged: the loss is not a number", Remedy::kBeginWithHull);
        run.add(result, step.weights);
        if (seconds_now() - run.reported >= 1) go_on = callback(run.report(settings, psi));
    }
    if (run.steps > 0) callback(run.report(settings, psi));  // else the last step is reported already
}

}  // namespace

PsiSettings default_psi_settings(const gpu::Device& device) {
    PsiSettings settings;
    if (device.summary().kind != "cpu") return settings;
    settings.width = 32;
    settings.layers = 3;
    settings.sampling = {16, 16};
    settings.frequencies = 6;
    settings.tiles_per_step = 16;
    settings.points_per_leaf = 64;
    return settings;
}

voctree::VOctree tree_from_psi(PsiStep& psi, const voctree::VOctree& hull, uint32_t levels_above,
                               const PsiSettings& settings) {
    const PsiNetwork network = psi.network();
    const std::vector<voctree::LeafPosition> positions =
        dense_positions(psi, network, hull, levels_above, settings.threshold);
    if (positions.empty()) throw RuntimeFailure("Ψ found no matter", Remedy::kTrainLonger);
    voctree::VOctree tree = hull;
    voctree::build_topology(tree, positions);
    set_mean_weights(psi, network, tree, settings);
    const auto rows = [&](uint32_t first) {
        const auto at = network.parameters.begin() + first;
        return std::vector<float>(at, at + tree.frames * tree.bases);
    };
    tree.sigma_basis = rows(network.shape.sigma_rows_offset());
    tree.gamma_basis = rows(network.shape.gamma_rows_offset());
    return tree;
}

voctree::VOctree psi_tree(const gpu::Device& device, const Dataset& dataset, const TreeShape& shape,
                          uint32_t levels_above, const PsiSettings& settings, const PsiCallback& callback) {
    const voctree::VOctree hull = initial_tree(dataset, shape, levels_above);
    const auto box = hull_box(dataset);
    const PsiShape psi_shape{.frequencies = settings.frequencies,
                             .width = settings.width,
                             .layers = settings.layers,
                             .bases = hull.bases,
                             .hh_degree = hull.hh_degree,
                             .frames = hull.frames};
    PsiStep psi(device, initial_psi(psi_shape, glm::vec3(box.first), glm::vec3(box.second - box.first), settings.seed),
                settings.sampling, static_cast<uint32_t>(dataset.cameras.size()), settings.tiles_per_step);
    train_psi(psi, dataset, settings, callback);
    return tree_from_psi(psi, hull, levels_above, settings);
}

}  // namespace neuvv::training
