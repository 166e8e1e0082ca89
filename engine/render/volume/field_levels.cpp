#include "render/volume/field_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/volume/trace.h"
#include "voctree/coarse.h"
#include "voctree/temporal_basis.h"

namespace neuvv::render {

namespace {

// The coarsest level's cells are an eighth of the box wide: seen from farther away, a performer is a few pixels.
constexpr uint32_t kCoarsestDepth = 3;
// A level has at most so large a part of the leaves of the next finer one. A surface has a quarter at each depth; where
// leaves are scattered, cells contain little more than one, and a level would cost memory and look no better.
constexpr uint32_t kMinReduction = 2;

// Metres: the longest edge of the finest leaves.
double finest_edge_m(const Field& field) {
    const double box_m = double{std::max({field.box_size.x, field.box_size.y, field.box_size.z})};
    return std::ldexp(box_m, -static_cast<int>(field.finest_level + field.levels_above));
}

// The least singular value of a matrix divided by the largest: 1 where it scales all directions alike. Singular values
// are the square roots of the eigenvalues of AᵀA, which have a closed form, as it is a symmetric 3×3 matrix.
double evenness(const glm::dmat3& a) {
    const glm::dmat3 m = glm::transpose(a) * a;
    const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
    const glm::dmat3 deviation = (m - glm::dmat3(mean)) / mean;
    const double squares = glm::dot(deviation[0], deviation[0]) + glm::dot(deviation[1], deviation[1]) +
                           glm::dot(deviation[2], deviation[2]);
    constexpr double kRounding = 1e-12;  // of the squares, where transforms are floats
    if (squares < kRounding) return 1;
    const double radius = std::sqrt(squares / 6);
    const double half_determinant = glm::determinant(deviation / radius) / 2;
    const double angle = std::acos(std::clamp(half_determinant, -1.0, 1.0)) / 3;
    const double largest = 1 + 2 * radius * std::cos(angle);
    const double least = 1 + 2 * radius * std::cos(angle + 2 * std::numbers::pi / 3);
    return std::sqrt(std::max(least, 0.0) / largest);
}

// Metres of the performer's space, at its leaves that are nearest to the eye, for an even scale.
double between_rays_m(const Field& field, const stage::Camera& camera, const glm::mat4& world_from_performer,
                      uint32_t samples) {
    const glm::vec3 eye(in_performer(camera, world_from_performer).world_from_camera[3]);
    const glm::vec3 outside = glm::max(glm::max(field.leaves_min - eye, eye - field.leaves_max), 0.0f);
    return double{glm::length(outside)} / (samples * std::max(camera.fx, camera.fy));
}

// Then a cell has a density for each frame, which can cover what its leaves cover there. Where frames share bases it
// cannot, and levels look worse than the finest leaves (engine/render/README.md).
bool has_basis_for_each_frame(const voctree::VOctree& tree) {
    return voctree::basis_entries(tree.sigma_basis, tree.bases).size() <= tree.frames;
}

}  // namespace

Field upload_far_levels(const gpu::Device& device, const voctree::VOctree& tree) {
    Field field = upload_field(device, tree, WeightPrecision::kHalf);
    uint32_t depth = voctree::finest_depth(tree);
    if (depth <= kCoarsestDepth || !has_basis_for_each_frame(tree)) return field;
    voctree::VOctree cut = voctree::cut_tree(tree, --depth);
    uint32_t finer_leaves = field.leaf_count;
    for (;; cut = voctree::cut_tree(cut, --depth)) {
        if (cut.leaf_count <= finer_leaves / kMinReduction) {
            field.coarser.push_back(upload_field(device, cut, WeightPrecision::kHalf));
            finer_leaves = cut.leaf_count;
        }
        if (depth == kCoarsestDepth) break;
    }
    return field;
}

uint32_t far_level_for(const Field& field, std::span<const stage::Camera> cameras,
                       const glm::mat4& world_from_performer, uint32_t samples) {
    if (field.coarser.empty()) return 0;
    double closest_m = INFINITY;
    for (const stage::Camera& camera : cameras)
        closest_m = std::min(closest_m, between_rays_m(field, camera, world_from_performer, samples));
    // Where the performer is squashed, rays are closer together along one direction than along another.
    closest_m *= evenness(glm::dmat3(world_from_performer));
    const auto fits = [&](const Field& coarser) { return finest_edge_m(coarser) <= closest_m; };
    return static_cast<uint32_t>(std::ranges::find_if_not(field.coarser, fits) - field.coarser.begin());
}

FieldLevels::FieldLevels(std::vector<const Field*> given) : all(std::move(given)) {
    const auto fields = static_cast<uint32_t>(all.size());
    for (uint32_t field = 0; field < fields; ++field) given_of.push_back(field);
    for (uint32_t field = 0; field < fields; ++field) {
        first_coarser.push_back(static_cast<uint32_t>(all.size()));
        for (const Field& coarser : all[field]->coarser) {
            all.push_back(&coarser);
            given_of.push_back(field);
        }
    }
}

}  // namespace neuvv::render
