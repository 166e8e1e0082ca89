// Eye: copies the images of all views to a headset's images, in linear light, as the format of these encodes. It also
// writes depth, so that hands and panels are hidden by what is before them: the depth of performers where the ray's
// alpha is at least one half (errata 12), else that of the set.
// Reads image and rays; writes premultiplied light, and as depth near_m / metres along the axis. One invocation per
// pixel of all views. Bound by memory: 28 bytes per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/eye.h"
#include "shared/trace.h"

READ_ARRAY(uint, kEyeImage, image);
READ_ARRAY(vec4, kEyeRadiance, radiance);
READ_ARRAY(float, kEyeDepth, depth);
layout(binding = kEyeCameras) uniform textureBuffer cameras;
READ_ARRAY(float, kEyeSetDepth, set_depth);
layout(location = 0) flat in uint view;
layout(push_constant) uniform Push { EyePush push; };
layout(location = 0) out vec4 light;

#include "rays/grid.glsl"
#include "srgb.glsl"

float metres_at(uvec2 pixel, int texel) {
    const vec2 at = vec2(pixel) + 0.5;
    const vec2 rays = vec2(ray_of_pixel(camera_axis(view, 0u), at.x), ray_of_pixel(camera_axis(view, 1u), at.y));
    const uvec2 cell = uvec2(clamp(rays, vec2(0.0), vec2(push.tiles_across, push.tiles_down) * float(kTile) - 1.0));
    const uvec2 tile = cell / kTile, inner = cell % kTile;
    const int ray =
        int(((view * push.tiles_down + tile.y) * push.tiles_across + tile.x) * kTilePixels + inner.y * kTile + inner.x);
    if (FETCH(radiance, ray).a < 0.5) return FETCH(set_depth, texel).x;
    return FETCH(depth, ray).x / length(camera_line(view, at));
}

// The darkness of the vignette at a position of the image, 0 to 1. It grows with the angle from the optical axis, which
// is not the image's centre: so both eyes see it in the same directions.
float vignette(vec2 at) {
    const vec3 line = camera_line(view, at);
    const float from_axis = sqrt(max(dot(line, line) - 1.0, 0.0));
    return push.vignette * smoothstep(mix(kWeakFrom, kStrongFrom, push.vignette),
                                      mix(kWeakBlack, kStrongBlack, push.vignette), from_axis);
}

void main() {
    const uvec2 pixel = uvec2(gl_FragCoord.xy);
    const int texel = int((view * push.height + pixel.y) * push.width + pixel.x);
    const vec4 colour = unpackUnorm4x8(FETCH(image, texel).x);
    light = vec4(srgb_decode(colour.rgb) * colour.a, colour.a);
    const float darkness = max(push.fade, push.vignette > 0.0 ? vignette(gl_FragCoord.xy) : 0.0);
    light = mix(light, vec4(0.0, 0.0, 0.0, 1.0), darkness);
    gl_FragDepth = clamp(push.near_m / metres_at(pixel, texel), 0.0, 1.0);
}
