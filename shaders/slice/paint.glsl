// The colour of a leaf under paint (errata 14). Paint changes the leaf's mean colour c = sigmoid(k_00 Y_00). Each layer
// mixes c, with weight w = opacity · alpha, with
//   normal    g, the target
//   multiply  c g
//   tint      c g, with the luminance of c: as if lit by g
//   recolour  g, with the luminance of c: hue and saturation are the target's
// and the logit of the result replaces k_00 Y_00. The coefficients of higher degree, which let the colour depend on the
// direction of view, are multiplied by `keep`, the product of 1 − w over normal layers, and each is mixed with its
// luminance by the weight `grey`: a tint or recolour keeps changes of brightness with direction, but not those of hue.
#ifndef NEUVV_PAINT_GLSL
#define NEUVV_PAINT_GLSL

const float kShConstant = 0.28209479;  // Y_00

struct Painted {
    vec3 colour;
    float keep;
    float grey;
};

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// The colour c scaled to a luminance (0 to 1); its saturation is reduced where a channel would exceed 1.
vec3 with_luminance(vec3 c, float target) {
    const float current = luminance(c);
    if (current < 1e-6) return vec3(target);
    const vec3 scaled = c * (target / current);
    const float largest = max(scaled.r, max(scaled.g, scaled.b));
    return largest > 1.0 ? target + (scaled - target) * ((1.0 - target) / (largest - target)) : scaled;
}

vec3 blend(uint mode, vec3 c, vec3 target) {
    switch (mode) {
        case kPaintMultiply: return c * target;
        case kPaintTint: return with_luminance(c * target, luminance(c));
        case kPaintRecolour: return with_luminance(target, luminance(c));
        default: return target;
    }
}

// Applies a layer to the leaf as the layers below have left it; `part` is w.
void paint_over(inout Painted leaf, uint mode, float part, vec3 target) {
    leaf.colour = mix(leaf.colour, blend(mode, leaf.colour, target), part);
    if (mode == kPaintNormal) leaf.keep *= 1.0 - part;
    if (mode == kPaintTint || mode == kPaintRecolour) leaf.grey = 1.0 - (1.0 - leaf.grey) * (1.0 - part);
}

vec3 painted_mean(Painted leaf) {
    const vec3 c = clamp(leaf.colour, kPaintBlack, 1.0 - kPaintBlack);
    return log(c / (1.0 - c)) / kShConstant;
}

vec3 painted_coefficient(Painted leaf, vec3 k) { return leaf.keep * mix(k, vec3(luminance(k)), leaf.grey); }

#endif
