#include "training/tree/hull.h"

#include <algorithm>

#include "base/threads/parallel.h"
#include "base/trace_file.h"
#include "training/tree/silhouettes.h"

namespace neuvv::training {

std::vector<HullCell> grid_cells(const std::pair<glm::dvec3, glm::dvec3>& box, uint32_t side) {
    const glm::dvec3 size = (box.second - box.first) / static_cast<double>(side);
    std::vector<HullCell> cells;
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                cells.push_back({glm::vec3(box.first + size * (glm::dvec3(x, y, z) + 0.5)),
                                 static_cast<float>(0.5 * glm::length(size))});
    return cells;
}

std::vector<uint32_t> carve(const Dataset& dataset, const std::vector<HullCell>& cells) {
    const TraceSpan span("carve", static_cast<int64_t>(cells.size()));
    const size_t words = hull_words(dataset);
    std::vector<uint32_t> bits(cells.size() * words);
    for (size_t t = 0; t < dataset.times.size(); ++t) {
        const std::vector<Silhouette> silhouettes = silhouettes_at(dataset, dataset.times[t]);
        const size_t least = min_witnesses(silhouettes);
        parallel_for(cells.size(), 4096, [&](size_t begin, size_t end) {
            const std::span<const HullCell> part(&cells[begin], end - begin);
            const std::vector<Witnesses> witnesses = count_witnesses(silhouettes, part);
            for (size_t i = begin; i < end; ++i)
                if (witnesses[i - begin].all >= least) bits[i * words + t / 32] |= 1u << t % 32;
        });
    }
    return bits;
}

}  // namespace neuvv::training
