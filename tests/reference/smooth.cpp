#include "reference/smooth.h"

#include <cmath>

namespace neuvv::reference {

namespace {

constexpr double kEpsilon = 0.1;

struct Cube {
    glm::i64vec3 low;
    int64_t size;
    bool contains(glm::i64vec3 cell) const {
        for (int axis = 0; axis < 3; ++axis)
            if (cell[axis] < low[axis] || cell[axis] >= low[axis] + size) return false;
        return true;
    }
};

Cube cube_of(const voctree::LeafPosition& position, uint32_t finest) {
    const int64_t size = int64_t{1} << (finest - position.depth);
    return {size * glm::i64vec3(position.x, position.y, position.z), size};
}

}  // namespace

std::array<uint32_t, 6> face_neighbours(const std::vector<voctree::LeafPosition>& positions, uint32_t leaf,
                                        uint32_t finest) {
    const Cube cube = cube_of(positions[leaf], finest);
    std::array<uint32_t, 6> found;
    for (size_t face = 0; face < 6; ++face) {
        const int axis = static_cast<int>(face / 2);
        glm::i64vec3 cell = cube.low + cube.size / 2;
        cell[axis] = face % 2 == 0 ? cube.low[axis] - 1 : cube.low[axis] + cube.size;
        found[face] = UINT32_MAX;
        for (uint32_t other = 0; other < positions.size(); ++other)
            if (cube_of(positions[other], finest).contains(cell)) found[face] = other;
    }
    return found;
}

double smoothness(double sigma, double edge, const std::array<double, 6>& neighbours) {
    double sum = 0;
    for (const double other : neighbours) {
        const double difference = std::exp(-other * edge) - std::exp(-sigma * edge);
        sum += std::sqrt(difference * difference + kEpsilon * kEpsilon);
    }
    return sum;
}

}  // namespace neuvv::reference
