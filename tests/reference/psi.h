// Ψ in double precision: positional encoding, the MLP, samples, importance sampling of rays, and the adjoints. Outputs
// are not folded with the rows A_t and B_t: a sample is computed from all w^σ, w^γ and w^HH, as that of a leaf is.
#pragma once

#include "reference/sample.h"

namespace neuvv::reference {

// (x, sin 2^k π x, cos 2^k π x) for k < frequencies.
std::vector<double> psi_encode(glm::dvec3 x, uint32_t frequencies);

// z = b + W h; numbers[k · outputs + o] is W_ko, the last row is b.
struct PsiLayer {
    size_t inputs = 0, outputs = 0;
    std::vector<double> numbers;
};
std::vector<double> layer_forward(const PsiLayer& layer, const std::vector<double>& h);
// ∂L/∂h; adds ∂L/∂W and ∂L/∂b to `gradient`.
std::vector<double> layer_adjoint(const PsiLayer& layer, const std::vector<double>& h, const std::vector<double>& d_z,
                                  PsiLayer& gradient);

struct Psi {
    uint32_t frequencies = 4, bases = 1, hh_degree = 0;
    double density = 1;  // 1/m for one unit of the network's w^σ
    std::vector<PsiLayer> hidden;
    PsiLayer output;  // w^σ | w^γ | w^HH R | G | B
};

// The last hidden layer's output at x, in the network's coordinates. There is a relu after every hidden layer.
std::vector<double> psi_hidden(const Psi& psi, glm::dvec3 x);
LeafWeights psi_forward(const Psi& psi, glm::dvec3 x);  // w^σ in 1/m

// Derivatives of a loss by all learnt parameters, laid out as these.
struct PsiGradient {
    Psi network;
    std::vector<double> row_a, row_b;
};
PsiGradient psi_gradient_begin(const Psi& psi);

// σ and colour at x from direction d at the time of the rows A_t, B_t.
struct PsiSample {
    double sigma = 0;  // 1/m
    glm::dvec3 colour{0};
};
PsiSample psi_sample(const Psi& psi, const std::vector<double>& row_a, const std::vector<double>& row_b, glm::dvec3 x,
                     glm::dvec3 direction);
// Adds one sample's gradient. With `revival` ≥ 0 (1/m), ∂L/∂σ also passes the relu where A_t·w^σ is not positive,
// unless it would move A_t·w^σ further down from −revival or below.
void psi_sample_adjoint(const Psi& psi, const std::vector<double>& row_a, const std::vector<double>& row_b,
                        glm::dvec3 x, glm::dvec3 direction, double d_sigma, glm::dvec3 d_colour, PsiGradient& gradient,
                        double revival = -1);

// The edges of `count` segments from t_0 to t_1 with equal shares of importance, given a density that is constant in
// each of sigmas.size() equal segments. The importance is 1 − `floor` parts blending weight and `floor` parts uniform;
// it is uniform where the ray's alpha is at most 1e-4.
std::vector<double> importance_edges(const std::vector<double>& sigmas, double t_0, double t_1, size_t count,
                                     double floor);

}  // namespace neuvv::reference
