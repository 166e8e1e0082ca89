// The sRGB transfer function (IEC 61966-2-1) for linear values ≥ 0; above 1 the power law continues.
#ifndef NEUVV_SRGB_GLSL
#define NEUVV_SRGB_GLSL

vec3 srgb_encode(vec3 linear) {
    const vec3 x = max(linear, vec3(0.0));
    return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

// The inverse of srgb_encode for 0 to 1.
vec3 srgb_decode(vec3 encoded) {
    return mix(pow((encoded + 0.055) / 1.055, vec3(2.4)), encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}

// d srgb_encode / d linear
vec3 srgb_encode_adjoint(vec3 linear) {
    const vec3 x = max(linear, vec3(0.0031308));
    return mix((1.055 / 2.4) * pow(x, vec3(1.0 / 2.4 - 1.0)), vec3(12.92), lessThanEqual(linear, vec3(0.0031308)));
}

#endif
