#include "gradient/chain.h"

#include <algorithm>
#include <cmath>

#include "reference/smooth.h"

namespace neuvv::test {
namespace {

constexpr double kNudge = 1e-5;

// A_t or B_t in double precision.
std::vector<double> row_at(const std::vector<double>& basis, uint32_t bases, const reference::FrameRows& rows) {
    std::vector<double> row(bases);
    for (size_t i = 0; i < bases; ++i)
        row[i] = (1 - rows.blend) * basis[rows.first * size_t{bases} + i] +
                 rows.blend * basis[rows.second * size_t{bases} + i];
    return row;
}

double& weight_of(reference::LeafWeights& weights, uint32_t bases, uint32_t functions, uint32_t weight) {
    if (weight < bases) return weights.sigma[weight];
    if (weight < 2 * bases) return weights.gamma[weight - bases];
    return weights.hh[(weight - 2 * bases) / functions][(weight - 2 * bases) % functions];
}

template <typename Loss>
double central_difference(double& parameter, const Loss& loss) {
    const double before = parameter;
    parameter = before + kNudge;
    const double above = loss();
    parameter = before - kNudge;
    const double below = loss();
    parameter = before;
    loss();  // restores everything that depends on the parameter
    return (above - below) / (2 * kNudge);
}

}  // namespace

Chain::Chain(const Scene& scene)
    : scene_(scene),
      sigma_basis_(scene.tree.sigma_basis.begin(), scene.tree.sigma_basis.end()),
      gamma_basis_(scene.tree.gamma_basis.begin(), scene.tree.gamma_basis.end()),
      slices_(scene.tree.leaf_count),
      tiles_of_leaf_(scene.tree.leaf_count) {
    for (uint32_t leaf = 0; leaf < scene.tree.leaf_count; ++leaf)
        weights_.push_back(reference::leaf_weights(scene.tree, leaf));
    for (size_t tile = 0; tile < scene.tiles.size(); ++tile)
        for (uint32_t lane = 0; lane < kTilePixels; ++lane) {
            const reference::Ray ray = ray_of(scene, scene.tiles[tile], lane);
            rays_.push_back({ray.direction, reference::intersect(scene.tree, ray)});
            if (scene.target[rays_.size() - 1].a < 0) continue;
            for (const reference::LeafInterval& interval : rays_.back().intervals) {
                std::vector<size_t>& tiles = tiles_of_leaf_[interval.leaf];
                if (tiles.empty() || tiles.back() != tile) tiles.push_back(tile);
            }
        }
    slice_rows();
    for (const reference::LeafSlice& slice : slices_) first_sigmas_.push_back(slice.sigma);
    positions_ = voctree::leaf_positions(scene.tree);
    seen_ = seen_leaves();
}

void Chain::slice_leaf(uint32_t leaf) {
    slices_[leaf] = reference::slice(weights_[leaf], row_a_, row_b_, scene_.tree.hh_degree);
}

void Chain::slice_rows() {
    const auto rows = reference::frame_rows(static_cast<double>(scene_.frame), scene_.tree.frames);
    row_a_ = row_at(sigma_basis_, scene_.tree.bases, rows);
    row_b_ = row_at(gamma_basis_, scene_.tree.bases, rows);
    for (uint32_t leaf = 0; leaf < slices_.size(); ++leaf) slice_leaf(leaf);
}

std::vector<reference::Sample> Chain::samples(const PathRay& ray) const {
    std::vector<reference::Sample> result;
    for (const reference::LeafInterval& interval : ray.intervals) {
        const reference::LeafSlice& leaf = slices_[interval.leaf];
        if (leaf.sigma == 0) continue;
        result.push_back({leaf.sigma, reference::sample_colour(leaf, scene_.tree.hh_degree, ray.direction),
                          interval.t_exit - interval.t_enter, 0});
    }
    return result;
}

// The point loss of a ray, with the current colours, but with blending weights by the first densities.
double Chain::ray_point_loss(const PathRay& ray, glm::dvec4 truth) const {
    std::vector<reference::Sample> now;
    for (const reference::LeafInterval& interval : ray.intervals)
        if (first_sigmas_[interval.leaf] > 0)
            now.push_back({first_sigmas_[interval.leaf],
                           reference::sample_colour(slices_[interval.leaf], scene_.tree.hh_degree, ray.direction),
                           interval.t_exit - interval.t_enter, 0});
    return reference::point_loss(now, glm::dvec3(truth), truth.a, static_cast<double>(scene_.stop));
}

double Chain::tile_loss(size_t tile) const {
    reference::Patch patch;
    double point = 0;
    for (size_t i = 0; i < kTilePixels; ++i) {
        const size_t ray = tile * kTilePixels + i;
        const glm::dvec4 truth(scene_.target[ray]);
        patch[i].inside = truth.a >= 0;
        if (!patch[i].inside) continue;
        point += ray_point_loss(rays_[ray], truth);
        const reference::RayResult seen = reference::composite(samples(rays_[ray]), static_cast<double>(scene_.stop));
        patch[i].colour = seen.colour;
        patch[i].alpha = seen.alpha;
        patch[i].true_colour = glm::dvec3(truth);
        patch[i].true_alpha = truth.a;
        patch[i].background = glm::dvec3(scene_.background[ray]);
    }
    return reference::patch_loss(patch, 1).total(static_cast<double>(scene_.weights.grad)) +
           static_cast<double>(scene_.weights.point) * point;
}

double Chain::loss() const {
    double sum = 0;
    for (size_t tile = 0; tile < scene_.tiles.size(); ++tile) sum += tile_loss(tile);
    if (scene_.weights.smoothness > 0)
        for (const uint32_t leaf : seen_) sum += leaf_smoothness(leaf);
    return sum;
}

// A leaf's term of the smoothness loss, weighted, with its current density and the first densities of its neighbours.
double Chain::leaf_smoothness(uint32_t leaf) const {
    std::array<double, 6> neighbours{};
    const std::array<uint32_t, 6> found = reference::face_neighbours(positions_, leaf, 2 * scene_.tree.node_levels);
    for (size_t i = 0; i < 6; ++i) neighbours[i] = found[i] == UINT32_MAX ? 0 : first_sigmas_[found[i]];
    const double edge = static_cast<double>(scene_.tree.box_size.x) / (1u << positions_[leaf].depth);
    return static_cast<double>(scene_.weights.smoothness) *
           reference::smoothness(slices_[leaf].sigma, edge, neighbours);
}

double Chain::by_weight(uint32_t leaf, uint32_t weight) {
    double& parameter = weight_of(weights_[leaf], scene_.tree.bases, hh_count(scene_.tree.hh_degree), weight);
    return central_difference(parameter, [&] {
        slice_leaf(leaf);
        double sum = 0;
        for (const size_t tile : tiles_of_leaf_[leaf]) sum += tile_loss(tile);
        if (scene_.weights.smoothness > 0 && std::binary_search(seen_.begin(), seen_.end(), leaf))
            sum += leaf_smoothness(leaf);
        return sum;
    });
}

double Chain::by_row(bool of_gamma, size_t element) {
    return central_difference((of_gamma ? gamma_basis_ : sigma_basis_)[element], [&] {
        slice_rows();
        return loss();
    });
}

std::vector<uint32_t> Chain::seen_leaves() const {
    std::vector<bool> seen(slices_.size());
    for (size_t i = 0; i < rays_.size(); ++i) {
        if (scene_.target[i].a < 0) continue;
        double transmittance = 1;
        for (const reference::LeafInterval& interval : rays_[i].intervals) {
            if (transmittance < static_cast<double>(scene_.stop)) break;
            const double sigma = slices_[interval.leaf].sigma;
            transmittance *= std::exp(-sigma * (interval.t_exit - interval.t_enter));
            if (sigma > 0) seen[interval.leaf] = true;
        }
    }
    std::vector<uint32_t> leaves;
    for (uint32_t leaf = 0; leaf < seen.size(); ++leaf)
        if (seen[leaf]) leaves.push_back(leaf);
    return leaves;
}

uint32_t Chain::rays_ended_early() const {
    uint32_t count = 0;
    for (size_t i = 0; i < rays_.size(); ++i) {
        const std::vector<reference::Sample> all = samples(rays_[i]);
        const double stop = static_cast<double>(scene_.stop);
        count += reference::composite(all, stop).alpha < reference::composite(all, 0).alpha ? 1 : 0;
    }
    return count;
}

}  // namespace neuvv::test
