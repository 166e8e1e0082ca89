// Mirror: the left eye's image for a window on the desktop, with the panel where the image is transparent because the
// panel lies beneath it. Reads the eye's image in linear light and the panel's image in sRGB; writes sRGB.
// One invocation per pixel. Bound by memory: 12 bytes per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/mirror.h"

layout(binding = kMirrorEye) uniform sampler2D eye;
layout(binding = kMirrorPanel) uniform sampler2D panel;
layout(location = 0) out vec4 colour;
layout(push_constant) uniform Push { MirrorPush push; };

#include "srgb.glsl"

// The panel's linear colour where this pixel's line of sight meets it from its front, else black.
vec3 panel_light(vec2 clip) {
    const vec3 at = mat3(push.panel_from_clip) * vec3(clip, 1.0);
    const vec2 uv = at.xy / at.z;
    const bool is_hit = push.has_panel != 0u && at.z > 0.0 && all(greaterThanEqual(uv, vec2(0.0))) &&
                        all(lessThan(uv, vec2(1.0)));
    return is_hit ? srgb_decode(textureLod(panel, uv, 0.0).rgb) : vec3(0.0);
}

void main() {
    const vec2 size = vec2(textureSize(eye, 0));
    const vec4 seen = texelFetch(eye, ivec2(gl_FragCoord.xy), 0);
    const vec3 light = seen.rgb + (1.0 - seen.a) * panel_light(gl_FragCoord.xy / size * 2.0 - 1.0);
    colour = vec4(srgb_encode(light), 1.0);
}
