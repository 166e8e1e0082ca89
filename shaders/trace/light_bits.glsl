// Packs light into one word, as Vulkan's E5B9G9R9: nine bits per channel with a shared exponent.
#ifndef NEUVV_LIGHT_BITS_GLSL
#define NEUVV_LIGHT_BITS_GLSL

uint bits_of_light(vec3 light) {
    const vec3 clamped = clamp(light, vec3(0.0), vec3(65408.0));
    const float brightest = max(max(clamped.x, clamped.y), max(clamped.z, 1e-5));
    int exponent = max(-16, int(floor(log2(brightest)))) + 1;
    if (round(brightest * exp2(float(9 - exponent))) > 511.0) ++exponent;
    const uvec3 parts = uvec3(round(clamped * exp2(float(9 - exponent))));
    return parts.x | parts.y << 9u | parts.z << 18u | uint(exponent + 15) << 27u;
}

vec3 light_of_bits(uint bits) {
    const uvec3 parts = uvec3(bits, bits >> 9u, bits >> 18u) & 511u;
    return vec3(parts) * exp2(float(int(bits >> 27u) - 15 - 9));
}

#endif
