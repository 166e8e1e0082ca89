#include "training/tree/carved_leaves.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace neuvv::training {

namespace {

bool any_bit(const uint32_t* bits, size_t words) {
    return std::any_of(bits, bits + words, [](uint32_t word) { return word != 0; });
}

// The bits of carve(), one per time of the data set, as one bit per frame of the tree.
std::vector<uint32_t> frame_bits(const Dataset& dataset, uint32_t frames, const uint32_t* bits) {
    std::vector<uint32_t> result((frames + 31) / 32);
    for (size_t i = 0; i < dataset.times.size(); ++i) {
        if (!(bits[i / 32] >> i % 32 & 1)) continue;
        const double frame = frame_of_time(dataset.times[i], frames);
        for (const double near : {std::floor(frame), std::ceil(frame)})
            result[static_cast<size_t>(near) / 32] |= 1u << static_cast<uint32_t>(near) % 32;
    }
    return result;
}

}  // namespace

HullCell hull_cell(const voctree::VOctree& tree, const voctree::LeafPosition& position, uint32_t finest,
                   double margin) {
    const float edge = tree.box_size.x / static_cast<float>(1u << position.depth);
    const glm::vec3 centre = tree.box_min + edge * (glm::vec3(position.x, position.y, position.z) + 0.5f);
    const float radius = edge * (position.depth < finest ? 0.5f * std::sqrt(3.0f) : 0.25f);
    return {centre, radius + static_cast<float>(margin)};
}

void append_children(std::vector<voctree::LeafPosition>& positions, const voctree::LeafPosition& position) {
    for (uint32_t i = 0; i < 8; ++i)
        positions.push_back(
            {2 * position.x + (i & 1), 2 * position.y + (i >> 1 & 1), 2 * position.z + (i >> 2), position.depth + 1});
}

Carved keep_allowed(const Dataset& dataset, const voctree::VOctree& tree,
                    const std::vector<voctree::LeafPosition>& positions, uint32_t finest, double margin) {
    const size_t words = hull_words(dataset);
    std::vector<HullCell> cells(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) cells[i] = hull_cell(tree, positions[i], finest, margin);
    const std::vector<uint32_t> bits = carve(dataset, cells);
    Carved kept;
    for (size_t i = 0; i < positions.size(); ++i) {
        if (!any_bit(&bits[i * words], words)) continue;
        kept.positions.push_back(positions[i]);
        kept.bits.insert(kept.bits.end(), &bits[i * words], &bits[i * words] + words);
        kept.kept.push_back(static_cast<uint32_t>(i));
    }
    return kept;
}

void fit_to_hull(const Dataset& dataset, const voctree::VOctree& tree, const Carved& carved, size_t i,
                 std::vector<float>& values) {
    const auto allowed = frame_bits(dataset, tree.frames, &carved.bits[i * hull_words(dataset)]);
    const float below = -density_of(tree, carved.positions[i].depth, kForbiddenOpacity);
    for (size_t t = 0; t < values.size(); ++t)
        if (!(allowed[t / 32] >> t % 32 & 1)) values[t] = std::min(values[t], below);
}

double footprint_at(const Dataset& dataset, glm::dvec3 position) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const stage::Camera& camera : dataset.cameras)
        smallest = std::min(smallest, glm::length(glm::dvec3(camera.world_from_camera[3]) - position) / camera.fx);
    return smallest;
}

}  // namespace neuvv::training
