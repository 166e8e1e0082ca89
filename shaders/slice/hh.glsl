// Radial factors of the hyperspherical harmonics: R_nl(γ) = A_nl sin^l γ C^{l+1}_{n−l}(cos γ), errata 1, 2 and 7.
// H_nlm(d, γ) = R_nl(γ) Y_lm(d). Expects kHhDegree (a specialisation constant).
#ifndef NEUVV_HH_GLSL
#define NEUVV_HH_GLSL

const float kPi = 3.14159265358979;

// A_nl = 2^l l! sqrt(2(n+1)(n−l)! / (π(n+l+1)!))
const float kA_n0 = sqrt(2.0 / kPi);
const float kA_11 = 2.0 * sqrt(2.0 / (3.0 * kPi));
const float kA_21 = 2.0 * sqrt(1.0 / (4.0 * kPi));
const float kA_22 = 8.0 * sqrt(1.0 / (20.0 * kPi));
const float kA_31 = 2.0 * sqrt(2.0 / (15.0 * kPi));
const float kA_32 = 8.0 * sqrt(1.0 / (90.0 * kPi));
const float kA_33 = 48.0 * sqrt(1.0 / (630.0 * kPi));

// R_nl in rows of equal l; column n. Entries with n < l or n > kHhDegree are 0.
struct HhRadial {
    vec4 l0, l1, l2, l3;
};

HhRadial hh_radial(float gamma) {
    const float c = cos(gamma), s = sin(gamma);
    HhRadial r;
    r.l0 = kA_n0 * vec4(1.0, 2.0 * c, 4.0 * c * c - 1.0, 8.0 * c * c * c - 4.0 * c);
    r.l1 = s * vec4(0.0, kA_11, kA_21 * 4.0 * c, kA_31 * (12.0 * c * c - 2.0));
    r.l2 = s * s * vec4(0.0, 0.0, kA_22, kA_32 * 6.0 * c);
    r.l3 = s * s * s * vec4(0.0, 0.0, 0.0, kA_33);
    return r;
}

// dR_nl/dγ
HhRadial hh_radial_adjoint(float gamma) {
    const float c = cos(gamma), s = sin(gamma);
    HhRadial r;
    r.l0 = -s * kA_n0 * vec4(0.0, 2.0, 8.0 * c, 24.0 * c * c - 4.0);
    r.l1 = vec4(0.0, kA_11 * c, kA_21 * 4.0 * (c * c - s * s),
                kA_31 * (c * (12.0 * c * c - 2.0) - 24.0 * s * s * c));
    r.l2 = vec4(0.0, 0.0, kA_22 * 2.0 * s * c, kA_32 * (12.0 * s * c * c - 6.0 * s * s * s));
    r.l3 = vec4(0.0, 0.0, 0.0, kA_33 * 3.0 * s * s * c);
    return r;
}

// The index of the first function of degree n (errata 5, shared/hh_counts.h): H_nlm has index kHhBase[n] + l² + l + m.
const uint kHhBase[4] = uint[](0u, 1u, 5u, 14u);

#endif
