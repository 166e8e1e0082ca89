// Blends rays with the set and stores pixels; resolve.comp and upscale.comp share it. The includer has a ResolvePush as
// `push`, says by kSet whether there is a set, binds textureBuffer `cameras`, and declares the arrays
// `image`, `set_colour`, `set_front` and `set_depth`.
#ifndef NEUVV_SHOW_GLSL
#define NEUVV_SHOW_GLSL
#include "arrays.glsl"
#include "rays/grid.glsl"
#include "rays/image_pixel.glsl"
#include "srgb.glsl"

vec4 show_colour(vec4 light) {
    const vec4 sum = light + (1.0 - light.a) * vec4(push.background.rgb, 1.0) * push.background.a;
    return sum.a > 0.0 ? vec4(srgb_encode(sum.rgb / sum.a), sum.a) : vec4(0.0);
}

vec4 show_depth(float metres) {
    const float grey = 1.0 - (metres - push.depth_near) / (push.depth_far - push.depth_near);
    return vec4(vec3(isinf(metres) ? 0.0 : clamp(grey, 0.0, 1.0)), 1.0);
}

// Sums of rays: depth is metres / weight.
struct WeightedSum {
    vec4 light;    // premultiplied, linear
    float metres;  // times their weight
    float weight;
};

// A ray blended with the set at a texel of the set's image. `light` is the ray's, `metres` its depth.
WeightedSum with_set(uint view, uvec2 texel, vec4 light, float metres) {
    WeightedSum sum = WeightedSum(light, light.a > 0.0 ? light.a * metres : 0.0, light.a);
    if (!kSet) return sum;
    const int at = int((view * push.samples * push.height + texel.y) * push.samples * push.width + texel.x);
    const float set_metres = FETCH(set_depth, at).x;
    if (!isinf(set_metres)) {
        sum.metres += (1.0 - light.a) * set_metres * length(camera_line(view, vec2(texel) + 0.5));
        sum.weight += 1.0 - light.a;
    }
    const vec4 front = FETCH(set_front, at);
    sum.light = front + (1.0 - front.a) * (light + (1.0 - light.a) * FETCH(set_colour, at));
    return sum;
}

// Stores colour, alpha or depth, as push.show says, of premultiplied linear light and depth in metres.
void store_pixel(uint view, uvec2 pixel, vec4 light, float metres) {
    vec4 colour = show_colour(light);
    if (push.show == kShowAlpha) colour = vec4(light.aaa, 1.0);
    if (push.show == kShowDepth) colour = show_depth(metres);
    STORE(image, int((view * push.height + pixel.y) * push.width + pixel.x), uvec4(packUnorm4x8(colour)));
}

#endif
