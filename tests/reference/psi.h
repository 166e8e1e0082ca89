// Ψ in double precision: positional encoding, the MLP, a sample from it, how rays are sampled; and the adjoints.
// Outputs are not folded with the rows: a sample goes by way of all w^σ, w^γ, w^HH as a leaf's does.
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
    double density = 1;  // 1/m that one unit of w^σ stands for
    std::vector<PsiLayer> hidden;
    PsiLayer output;  // w^σ | w^γ | w^HH R | G | B
};

// x in the network's own coordinates. relu after every hidden layer.
std::vector<double> psi_hidden(const Psi& psi, glm::dvec3 x);
LeafWeights psi_forward(const Psi& psi, glm::dvec3 x);  // w^σ in 1/m

// Derivatives of a loss by everything learnt; laid out as what they belong to.
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
// Adds one sample's share. With `revival` ≥ 0 (1/m) ∂L/∂σ passes relu from below, too, unless it would push A_t·w^σ
// down from beneath −revival.
void psi_sample_adjoint(const Psi& psi, const std::vector<double>& row_a, const std::vector<double>& row_b,
                        glm::dvec3 x, glm::dvec3 direction, double d_sigma, glm::dvec3 d_colour, PsiGradient& gradient,
                        double revival = -1);

// Edges of `count` segments from t_0 to t_1 that a piecewise constant density over sigmas.size() equal segments makes
// equally important: by blending weight, `floor` of it spread evenly; evenly alone where alpha stays below 1e-4.
std::vector<double> importance_edges(const std::vector<double>& sigmas, double t_0, double t_1, size_t count,
                                     double floor);

}  // namespace neuvv::reference
