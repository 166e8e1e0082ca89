// From the head's outputs z to σ and colour of a sample: σ = relu(z_0), γ = π·sigmoid(z_1), c = sigmoid(Σ w_nlm R_nl(γ)
// Y_lm(d)) (errata 7–9). The file that includes this one defines kHhDegree, act_of_sample and set_act_of_sample.
#ifndef NEUVV_PSI_HEAD_GLSL
#define NEUVV_PSI_HEAD_GLSL
#include "slice/hh.glsl"
#include "slice/sh.glsl"

float head_gamma() { return kPi / (1.0 + exp(-act_of_sample(1u))); }

uint head_column(uint channel, uint n, uint j) { return 2u + channel * hh_count(kHhDegree) + kHhBase[n] + j; }

// Row l of R_nl
vec4 radial_row(HhRadial radial, uint l) {
    return l == 0u ? radial.l0 : l == 1u ? radial.l1 : l == 2u ? radial.l2 : radial.l3;
}

vec3 head_colour(float gamma, vec3 direction) {
    const HhRadial radial = hh_radial(gamma);
    const float y[kMaxShCount] = sh_basis(direction);
    vec3 raw = vec3(0.0);
    for (uint l = 0u; l <= kHhDegree; ++l) {
        const vec4 row = radial_row(radial, l);
        for (uint n = l; n <= kHhDegree; ++n)
            for (uint j = l * l; j < (l + 1u) * (l + 1u); ++j)
                for (uint channel = 0u; channel < 3u; ++channel)
                    raw[channel] += row[n] * y[j] * act_of_sample(head_column(channel, n, j));
    }
    return 1.0 / (1.0 + exp(-raw));
}

// Whether ∂L/∂σ is passed on to z. By relu's derivative it is only where σ > 0. But a few first steps can empty all of
// space, and such a network would never get a gradient again. With `revival` ≥ 0, gradients therefore move z where σ =
// 0, too: up from anywhere, down no further than −revival. They are the derivatives by σ from above, so matter comes
// back where it lowers the loss.
bool relu_passes(float z, float d_sigma, float revival) {
    return z > 0.0 || (revival >= 0.0 && (d_sigma < 0.0 || z > -revival));
}

// Replaces z by ∂L/∂z, given ∂L/∂σ and ∂L/∂c of this sample and its colour c.
void head_adjoint(vec3 direction, vec3 colour, float d_sigma, vec3 d_colour, float revival) {
    const float gamma = head_gamma();
    const HhRadial radial = hh_radial(gamma), slope = hh_radial_adjoint(gamma);
    const float y[kMaxShCount] = sh_basis(direction);
    const vec3 d_raw = d_colour * colour * (1.0 - colour);
    float d_gamma = 0.0;
    for (uint l = 0u; l <= kHhDegree; ++l) {
        const vec4 row = radial_row(radial, l), slope_row = radial_row(slope, l);
        for (uint n = l; n <= kHhDegree; ++n)
            for (uint j = l * l; j < (l + 1u) * (l + 1u); ++j)
                for (uint channel = 0u; channel < 3u; ++channel) {
                    const uint column = head_column(channel, n, j);
                    d_gamma += slope_row[n] * y[j] * act_of_sample(column) * d_raw[channel];
                    set_act_of_sample(column, row[n] * y[j] * d_raw[channel]);
                }
    }
    set_act_of_sample(0u, relu_passes(act_of_sample(0u), d_sigma, revival) ? d_sigma : 0.0);
    set_act_of_sample(1u, d_gamma * gamma * (1.0 - gamma / kPi));
    for (uint column = 2u + 3u * hh_count(kHhDegree); column < kHeadColumns; ++column) set_act_of_sample(column, 0.0);
}

#endif
