#include "training/hull.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "training/silhouettes.h"

namespace neuvv::training {

namespace {

bool may_hold_matter(const std::vector<Silhouette>& silhouettes, const HullCell& cell) {
    size_t seen = 0;
    for (const Silhouette& silhouette : silhouettes) {
        const Verdict verdict = judge(silhouette, cell);
        if (verdict == Verdict::kBackground) return false;
        if (verdict == Verdict::kMatter) seen++;
    }
    return seen >= std::min<size_t>(2, silhouettes.size());
}

// Where the cameras look: a cube around the point nearest to all optical axes, as large as the widest image there.
std::pair<glm::dvec3, glm::dvec3> box_from_cameras(const Dataset& dataset) {
    glm::dmat3 normal(0);
    glm::dvec3 right(0);
    for (const stage::Camera& camera : dataset.cameras) {
        const glm::dvec3 axis = -glm::dvec3(camera.world_from_camera[2]), origin(camera.world_from_camera[3]);
        const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(axis, axis);
        normal += across;
        right += across * origin;
    }
    if (std::abs(glm::determinant(normal)) < 1e-9)
        throw InputError(dataset.folder.string(), "",
                         "all cameras look the same way, so the scene's position is unknown",
                         "add \"aabb\": [[x,y,z],[x,y,z]] in metres to the transforms file");
    const glm::dvec3 centre = glm::inverse(normal) * right;
    double half = 0;
    for (const stage::Camera& camera : dataset.cameras) {
        const double distance = glm::length(glm::dvec3(camera.world_from_camera[3]) - centre);
        half = std::max(half, 0.5 * distance * std::max(camera.width / camera.fx, camera.height / camera.fy));
    }
    return {centre - half, centre + half};
}

}  // namespace

std::pair<glm::dvec3, glm::dvec3> first_box(const Dataset& dataset) {
    return dataset.box ? *dataset.box : box_from_cameras(dataset);
}

std::vector<HullCell> grid_cells(const std::pair<glm::dvec3, glm::dvec3>& box, uint32_t side) {
    const glm::dvec3 size = (box.second - box.first) / static_cast<double>(side);
    std::vector<HullCell> cells;
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t x = 0; x < side; x++)
                cells.push_back({glm::vec3(box.first + size * (glm::dvec3(x, y, z) + 0.5)),
                                 static_cast<float>(0.5 * glm::length(size))});
    return cells;
}

std::vector<uint32_t> carve(const Dataset& dataset, const std::vector<HullCell>& cells) {
    const size_t words = hull_words(dataset);
    std::vector<uint32_t> bits(cells.size() * words);
    for (size_t t = 0; t < dataset.times.size(); t++) {
        const std::vector<Silhouette> silhouettes = silhouettes_at(dataset, dataset.times[t]);
        parallel_for(cells.size(), 4096, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; i++)
                if (may_hold_matter(silhouettes, cells[i])) bits[i * words + t / 32] |= 1u << t % 32;
        });
    }
    return bits;
}

std::pair<glm::dvec3, glm::dvec3> hull_box(const Dataset& dataset) {
    std::pair<glm::dvec3, glm::dvec3> box = first_box(dataset);
    const size_t words = hull_words(dataset);
    for (int round = 0; round < 2; round++) {
        const std::vector<HullCell> cells = grid_cells(box, kBoxGrid);
        const std::vector<uint32_t> bits = carve(dataset, cells);
        const glm::dvec3 half = 0.5 * (box.second - box.first) / static_cast<double>(kBoxGrid);
        glm::dvec3 low = box.second, high = box.first;
        for (size_t i = 0; i < cells.size(); i++) {
            const auto first = bits.begin() + static_cast<ptrdiff_t>(i * words);
            if (std::none_of(first, first + static_cast<ptrdiff_t>(words), [](uint32_t word) { return word != 0; }))
                continue;
            low = glm::min(low, glm::dvec3(cells[i].centre) - half);
            high = glm::max(high, glm::dvec3(cells[i].centre) + half);
        }
        if (low.x >= high.x)
            throw InputError(dataset.folder.string(), "", "no point in space fits the mattes of the cameras",
                             "check that alpha is the matte, and that poses are camera-to-world with OpenGL axes");
        box = {low, high};
    }
    return box;
}

}  // namespace neuvv::training
