// Emission and absorption along a ray (the volume rendering equation; errata 10, 12), front to back.
#ifndef NEUVV_COMPOSITE_GLSL
#define NEUVV_COMPOSITE_GLSL

struct Composite {
    vec3 colour;          // Σ T_i α_i c_i: premultiplied by alpha
    float transmittance;  // T
    float depth;          // Σ T_i α_i z_i, metres
};

Composite composite_begin() { return Composite(vec3(0.0), 1.0, 0.0); }

// One interval of density σ (1/m), length δ (m), colour c, centre z (m). Returns its blending weight T α.
float composite_add(inout Composite sum, float sigma, float delta, vec3 c, float z) {
    const float alpha = 1.0 - exp(-sigma * delta);
    const float weight = sum.transmittance * alpha;
    sum.colour += weight * c;
    sum.depth += weight * z;
    sum.transmittance *= 1.0 - alpha;
    return weight;
}

// ∂L/∂σ of the interval that `so_far` has just taken in, given ∂L/∂C, ∂L/∂α̂ and the whole ray's result:
//   δ · ( ∂L/∂C · (T_{i+1} c_i − Σ_{j>i} T_j α_j c_j) + ∂L/∂α̂ · T_end )
float composite_adjoint(Composite so_far, Composite whole, float delta, vec3 c, vec3 d_colour, float d_alpha) {
    const vec3 behind = whole.colour - so_far.colour;
    return delta * (dot(d_colour, so_far.transmittance * c - behind) + d_alpha * whole.transmittance);
}

#endif
