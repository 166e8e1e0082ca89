// The colour of a leaf under paint (errata 14). What is painted is the leaf's mean colour c = sigmoid(k_00 Y_00): each
// layer takes it a part w = opacity · alpha of the way to
//   normal    g, the target
//   multiply  c g
//   tint      c g, made as bright as c: as if lit by g
//   recolour  g, made as bright as c: hue and saturation are the target's
// and it goes back into k_00 as its logit. The coefficients of higher degree, by which the leaf looks different from
// different sides, are multiplied by `keep` (the rest of 1 that normal layers leave), and of `grey` of each its
// luminance stands for all channels: tints and recolours leave light and shade, but no hue that turns.
#ifndef NEUVV_PAINT_GLSL
#define NEUVV_PAINT_GLSL

const float kShConstant = 0.28209479;  // Y_00

struct Painted {
    vec3 colour;
    float keep;
    float grey;
};

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// A colour of `wanted` luminance (0 to 1) with the hue of c and its saturation, or as much of it as there is room for.
vec3 with_luminance(vec3 c, float wanted) {
    const float own = luminance(c);
    if (own < 1e-6) return vec3(wanted);
    const vec3 scaled = c * (wanted / own);
    const float most = max(scaled.r, max(scaled.g, scaled.b));
    return most > 1.0 ? wanted + (scaled - wanted) * ((1.0 - wanted) / (most - wanted)) : scaled;
}

vec3 blend(uint mode, vec3 c, vec3 target) {
    switch (mode) {
        case kPaintMultiply: return c * target;
        case kPaintTint: return with_luminance(c * target, luminance(c));
        case kPaintRecolour: return with_luminance(target, luminance(c));
        default: return target;
    }
}

// One layer over what those below made of the leaf.
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
