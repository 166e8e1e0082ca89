#include "render/field_levels.h"

#include <algorithm>
#include <cmath>

#include "voctree/coarse.h"
#include "voctree/leaf_density.h"

namespace neuvv::render {

namespace {

// The coarsest level's cells are an eighth of the box wide: seen from farther away, a performer is a few pixels.
constexpr uint32_t kCoarsestDepth = 3;

// Metres: the longest edge of the finest leaves.
double finest_edge_m(const Field& field) {
    const double box_m = double{std::max({field.box_size.x, field.box_size.y, field.box_size.z})};
    return std::ldexp(box_m, -static_cast<int>(field.finest_level + field.levels_above));
}

// Then a cell has a density for each frame, which can cover what its leaves cover there. Where frames share bases it
// cannot, and levels look worse than the finest leaves (engine/README.md).
bool has_basis_for_each_frame(const voctree::VOctree& tree) {
    return voctree::basis_entries(tree.sigma_basis, tree.bases).size() <= tree.frames;
}

}  // namespace

Field upload_levels(const gpu::Device& device, const voctree::VOctree& tree) {
    Field field = upload_field(device, tree, WeightPrecision::kHalf);
    uint32_t depth = voctree::finest_depth(tree);
    if (depth <= kCoarsestDepth || !has_basis_for_each_frame(tree)) return field;
    voctree::VOctree cut = voctree::cut_tree(tree, --depth);
    field.coarser.push_back(upload_field(device, cut, WeightPrecision::kHalf));
    while (depth > kCoarsestDepth) {
        cut = voctree::cut_tree(cut, --depth);
        field.coarser.push_back(upload_field(device, cut, WeightPrecision::kHalf));
    }
    return field;
}

uint32_t level_for(const Field& field, std::span<const LevelView> views) {
    double between_rays_m = INFINITY;
    for (const LevelView& view : views) {
        const glm::vec3 eye(view.camera.world_from_camera[3]);
        const glm::vec3 outside = glm::max(glm::max(field.leaves_min - eye, eye - field.leaves_max), 0.0f);
        const double focal_rays = view.pixel_rays * std::max(view.camera.fx, view.camera.fy);
        between_rays_m = std::min(between_rays_m, double{glm::length(outside)} / focal_rays);
    }
    const auto fits = [&](const Field& coarser) { return finest_edge_m(coarser) <= between_rays_m; };
    return static_cast<uint32_t>(std::ranges::find_if_not(field.coarser, fits) - field.coarser.begin());
}

FieldLevels::FieldLevels(std::vector<const Field*> given) : all(std::move(given)), level_of(all.size()) {
    const size_t fields = all.size();
    for (size_t i = 0; i < fields; i++) {
        first_coarser.push_back(static_cast<uint32_t>(all.size()));
        for (const Field& coarser : all[i]->coarser) {
            all.push_back(&coarser);
            level_of.push_back(static_cast<uint32_t>(&coarser - all[i]->coarser.data()) + 1);
        }
    }
}

}  // namespace neuvv::render
