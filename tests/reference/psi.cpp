#include "reference/psi.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::reference {
namespace {

PsiLayer empty_like(const PsiLayer& layer) {
    return {layer.inputs, layer.outputs, std::vector<double>(layer.numbers.size())};
}

// The inputs of each layer: the encoding, then the hidden layers' outputs.
std::vector<std::vector<double>> activations_of(const Psi& psi, glm::dvec3 x) {
    std::vector<std::vector<double>> h = {psi_encode(x, psi.frequencies)};
    for (const PsiLayer& layer : psi.hidden) {
        h.push_back(layer_forward(layer, h.back()));
        for (double& value : h.back()) value = std::max(value, 0.0);
    }
    return h;
}

LeafWeights weights_of(const Psi& psi, const std::vector<double>& z) {
    LeafWeights weights;
    const auto at = [&](size_t i) { return z.begin() + static_cast<std::ptrdiff_t>(i); };
    const size_t bases = psi.bases, functions = hh_count(psi.hh_degree);
    weights.sigma.assign(at(0), at(bases));
    for (double& w : weights.sigma) w *= psi.density;
    weights.gamma.assign(at(bases), at(2 * bases));
    for (size_t c = 0; c < 3; ++c)
        weights.hh[c].assign(at(2 * bases + c * functions), at(2 * bases + (c + 1) * functions));
    return weights;
}

// The adjoint of weights_of: from derivatives by weights to derivatives by the outputs z.
std::vector<double> output_adjoint(const Psi& psi, const LeafWeights& d) {
    std::vector<double> d_z;
    for (const double value : d.sigma) d_z.push_back(psi.density * value);
    d_z.insert(d_z.end(), d.gamma.begin(), d.gamma.end());
    for (const std::vector<double>& channel : d.hh) d_z.insert(d_z.end(), channel.begin(), channel.end());
    return d_z;
}

}  // namespace

std::vector<double> psi_encode(glm::dvec3 x, uint32_t frequencies) {
    std::vector<double> features = {x.x, x.y, x.z};
    for (uint32_t k = 0; k < frequencies; ++k) {
        const double scale = std::ldexp(std::numbers::pi, static_cast<int>(k));
        for (int c = 0; c < 3; ++c) features.push_back(std::sin(scale * x[c]));
        for (int c = 0; c < 3; ++c) features.push_back(std::cos(scale * x[c]));
    }
    return features;
}

std::vector<double> layer_forward(const PsiLayer& layer, const std::vector<double>& h) {
    std::vector<double> z(layer.outputs);
    for (size_t o = 0; o < layer.outputs; ++o) {
        z[o] = layer.numbers[layer.inputs * layer.outputs + o];
        for (size_t k = 0; k < layer.inputs; ++k) z[o] += layer.numbers[k * layer.outputs + o] * h[k];
    }
    return z;
}

std::vector<double> layer_adjoint(const PsiLayer& layer, const std::vector<double>& h, const std::vector<double>& d_z,
                                  PsiLayer& gradient) {
    std::vector<double> d_h(layer.inputs);
    for (size_t o = 0; o < layer.outputs; ++o) {
        gradient.numbers[layer.inputs * layer.outputs + o] += d_z[o];
        for (size_t k = 0; k < layer.inputs; ++k) {
            gradient.numbers[k * layer.outputs + o] += h[k] * d_z[o];
            d_h[k] += layer.numbers[k * layer.outputs + o] * d_z[o];
        }
    }
    return d_h;
}

std::vector<double> psi_hidden(const Psi& psi, glm::dvec3 x) {
    return activations_of(psi, x).back();
}

LeafWeights psi_forward(const Psi& psi, glm::dvec3 x) {
    return weights_of(psi, layer_forward(psi.output, psi_hidden(psi, x)));
}

PsiGradient psi_gradient_begin(const Psi& psi) {
    PsiGradient gradient{psi, std::vector<double>(psi.bases), std::vector<double>(psi.bases)};
    for (PsiLayer& layer : gradient.network.hidden) layer = empty_like(layer);
    gradient.network.output = empty_like(psi.output);
    return gradient;
}

PsiSample psi_sample(const Psi& psi, const std::vector<double>& row_a, const std::vector<double>& row_b, glm::dvec3 x,
                     glm::dvec3 direction) {
    const LeafSlice at = slice(psi_forward(psi, x), row_a, row_b, psi.hh_degree);
    return {at.sigma, sample_colour(at, psi.hh_degree, direction)};
}

void psi_sample_adjoint(const Psi& psi, const std::vector<double>& row_a, const std::vector<double>& row_b,
                        glm::dvec3 x, glm::dvec3 direction, double d_sigma, glm::dvec3 d_colour, PsiGradient& gradient,
                        double revival) {
    const std::vector<std::vector<double>> h = activations_of(psi, x);
    const LeafWeights weights = weights_of(psi, layer_forward(psi.output, h.back()));
    const LeafSlice at = slice(weights, row_a, row_b, psi.hh_degree);
    const ShCoefficients d_k = sample_colour_adjoint(at, psi.hh_degree, direction, d_colour);
    SliceGradient d = slice_adjoint(weights, row_a, row_b, psi.hh_degree, d_sigma, d_k);
    double raw = 0;
    for (size_t c = 0; c < psi.bases; ++c) raw += row_a[c] * weights.sigma[c];
    if (raw <= 0 && revival >= 0 && (d_sigma < 0 || raw > -revival))
        for (size_t c = 0; c < psi.bases; ++c) {
            d.weights.sigma[c] = d_sigma * row_a[c];
            d.row_a[c] = d_sigma * weights.sigma[c];
        }
    for (size_t c = 0; c < psi.bases; ++c) {
        gradient.row_a[c] += d.row_a[c];
        gradient.row_b[c] += d.row_b[c];
    }
    std::vector<double> d_h =
        layer_adjoint(psi.output, h.back(), output_adjoint(psi, d.weights), gradient.network.output);
    for (size_t layer = psi.hidden.size(); layer-- > 0;) {
        for (size_t i = 0; i < d_h.size(); ++i)
            if (h[layer + 1][i] <= 0) d_h[i] = 0;
        d_h = layer_adjoint(psi.hidden[layer], h[layer], d_h, gradient.network.hidden[layer]);
    }
}

std::vector<double> importance_edges(const std::vector<double>& sigmas, double t_0, double t_1, size_t count,
                                     double floor) {
    const double step = (t_1 - t_0) / static_cast<double>(sigmas.size());
    std::vector<double> share;
    double transmittance = 1;
    for (const double sigma : sigmas) {
        share.push_back(transmittance * -std::expm1(-sigma * step));
        transmittance -= share.back();
    }
    const double alpha = 1 - transmittance;
    const double even = 1 / static_cast<double>(sigmas.size());
    for (double& s : share) s = alpha > 1e-4 ? (1 - floor) * s / alpha + floor * even : even;
    std::vector<double> edges = {t_0};
    for (size_t i = 1; i < count; ++i) {
        double left = static_cast<double>(i) / static_cast<double>(count);
        size_t bin = 0;
        while (bin + 1 < share.size() && left > share[bin]) left -= share[bin++];
        edges.push_back(t_0 + step * (static_cast<double>(bin) + std::min(left / share[bin], 1.0)));
    }
    edges.push_back(t_1);
    return edges;
}

}  // namespace neuvv::reference
