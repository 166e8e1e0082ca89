// PlenOctrees for tests: an N3Tree as svox has it in memory, how svox evaluates it, and its file.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "support/npz_files.h"
#include "support/random_tree.h"
#include "voctree/files/half.h"

namespace neuvv::test {

// svox' SH functions (with the Condon-Shortley phase), in its order.
inline std::vector<double> svox_basis(uint32_t functions, glm::dvec3 d) {
    const double x = d.x, y = d.y, z = d.z;
    std::vector<double> basis = {0.28209479177387814,
                                 -0.4886025119029199 * y,
                                 0.4886025119029199 * z,
                                 -0.4886025119029199 * x,
                                 1.0925484305920792 * x * y,
                                 -1.0925484305920792 * y * z,
                                 0.31539156525252005 * (2 * z * z - x * x - y * y),
                                 -1.0925484305920792 * x * z,
                                 0.5462742152960396 * (x * x - y * y),
                                 -0.5900435899266435 * y * (3 * x * x - y * y),
                                 2.890611442640554 * x * y * z,
                                 -0.4570457994644658 * y * (4 * z * z - x * x - y * y),
                                 0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y),
                                 -0.4570457994644658 * x * (4 * z * z - x * x - y * y),
                                 1.445305721320277 * z * (x * x - y * y),
                                 -0.5900435899266435 * x * (x * x - 3 * y * y)};
    basis.resize(functions);
    return basis;
}

// An N3Tree as svox has it in memory. With 0 `functions` its format is RGBA.
struct N3Tree {
    uint32_t functions = 9;
    bool halves = true;
    std::vector<int32_t> child;
    std::vector<float> data;
    glm::vec3 offset{0.5f}, invradius{0.25f, 0.5f, 0.125f};

    uint64_t nodes() const { return child.size() / 8; }
    uint64_t numbers() const { return 3 * std::max(functions, 1u) + 1; }
    std::string format() const { return functions == 0 ? "RGBA" : "SH" + std::to_string(functions); }

    const float* query(glm::dvec3 world, double* cell_side = nullptr) const {
        glm::dvec3 at = glm::dvec3(offset) + glm::dvec3(invradius) * world;
        uint64_t node = 0;
        for (double side = 0.5;; side /= 2) {
            at *= 2.0;
            const glm::dvec3 digit = glm::min(glm::floor(at), 1.0);
            at -= digit;
            const uint64_t cell = 8 * node + static_cast<uint64_t>(4 * digit.x + 2 * digit.y + digit.z);
            if (cell_side) *cell_side = side;
            if (child[cell] == 0) return &data[cell * numbers()];
            node = static_cast<uint64_t>(static_cast<int64_t>(node) + child[cell]);
        }
    }

    glm::dvec3 logits(const float* leaf, glm::dvec3 direction) const {
        if (functions == 0) return {leaf[0], leaf[1], leaf[2]};
        const std::vector<double> basis = svox_basis(functions, direction);
        glm::dvec3 sum(0);
        for (int channel = 0; channel < 3; ++channel)
            for (uint32_t i = 0; i < functions; ++i)
                sum[channel] += basis[i] * double{leaf[static_cast<uint32_t>(channel) * functions + i]};
        return sum;
    }

    std::map<std::string, std::string> arrays() const {
        std::string text;
        for (const char letter : format()) text += {letter, 0, 0, 0};
        std::vector<uint16_t> rounded;
        for (const float value : data) rounded.push_back(voctree::half_from_float(value));
        const auto of = [](glm::vec3 v) { return npy_bytes("<f4", {3}, bytes_of<float>({v.x, v.y, v.z})); };
        return {{"child", npy_bytes("<i4", {nodes(), 2, 2, 2}, bytes_of(child))},
                {"data", npy_bytes(halves ? "<f2" : "<f4", {nodes(), 2, 2, 2, numbers()},
                                   halves ? bytes_of(rounded) : bytes_of(data))},
                {"data_format", npy_bytes("<U" + std::to_string(format().size()), {}, text)},
                {"data_dim", npy_bytes("<i8", {}, bytes_of<int64_t>({static_cast<int64_t>(numbers())}))},
                {"invradius3", of(invradius)},
                {"offset", of(offset)}};
    }
};

constexpr uint32_t kNodes = 40, kCapacity = 43;

// Nodes are children of random cells; σ is negative, 0 or positive; data of nodes that no other node refers to is NaN.
inline N3Tree random_n3tree(uint32_t functions, bool halves, uint64_t seed) {
    Random random(seed);
    N3Tree tree;
    tree.functions = functions;
    tree.halves = halves;
    tree.child.resize(8 * kCapacity);
    tree.offset = {0.25f, 0.5f, 0.75f};
    for (uint32_t node = 1; node < kNodes;) {
        const uint32_t parent = random.below(node), cell = 8 * parent + random.below(8);
        if (tree.child[cell] != 0) continue;
        tree.child[cell] = static_cast<int32_t>(node - parent);
        ++node;
    }
    for (uint64_t cell = 0; cell < 8 * kCapacity; ++cell) {
        for (uint64_t i = 0; i + 1 < tree.numbers(); ++i) {
            const auto value = static_cast<float>(random.uniform(-3, 3));
            tree.data.push_back(halves ? voctree::float_from_half(voctree::half_from_float(value)) : value);
        }
        const float sigma[] = {-1, 0, 0.5f, 2.25f};
        tree.data.push_back(cell < 8 * kNodes ? sigma[random.below(4)] : std::nanf(""));
    }
    return tree;
}

}  // namespace neuvv::test
