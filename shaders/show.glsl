// What a pixel shows of the rays that it takes from, and where these stand. The includer pushes a ResolvePush, and binds
// uimageBuffer `picture`.
#ifndef NEUVV_SHOW_GLSL
#define NEUVV_SHOW_GLSL
#include "srgb.glsl"

vec4 show_colour(vec4 light) {
    const vec4 sum = light + (1.0 - light.a) * vec4(push.background.rgb, 1.0) * push.background.a;
    return sum.a > 0.0 ? vec4(srgb_encode(sum.rgb / sum.a), sum.a) : vec4(0.0);
}

vec4 show_depth(float metres) {
    const float grey = 1.0 - (metres - push.depth_near) / (push.depth_far - push.depth_near);
    return vec4(vec3(isinf(metres) ? 0.0 : clamp(grey, 0.0, 1.0)), 1.0);
}

// Where a ray of a view stands in the buffers.
int ray_at(uint view, uvec2 at) {
    const uvec2 tile = at / kTile, inner = at % kTile;
    const uint first = (view * push.tiles_down + tile.y) * push.tiles_across + tile.x;
    return int(first * kTilePixels + inner.y * kTile + inner.x);
}

// The pixel of this thread; false: it lies beyond the picture's edge, or the dispatch rounded the groups up. `group`: of all
// pictures' tiles.
bool pixel_of_thread(uint group, out uint view, out uvec2 pixel) {
    const uint across = (push.width + kTile - 1u) / kTile, down = (push.height + kTile - 1u) / kTile;
    const uint lane = gl_LocalInvocationID.x, tile = group % (across * down);
    view = group / (across * down);
    pixel = kTile * uvec2(tile % across, tile / across) + uvec2(lane % kTile, lane / kTile);
    return view < push.views && pixel.x < push.width && pixel.y < push.height;
}

// Premultiplied linear light, and depth in metres.
void store_pixel(uint view, uvec2 pixel, vec4 light, float metres) {
    vec4 shown = show_colour(light);
    if (push.show == kShowAlpha) shown = vec4(light.aaa, 1.0);
    if (push.show == kShowDepth) shown = show_depth(metres);
    imageStore(picture, int((view * push.height + pixel.y) * push.width + pixel.x), uvec4(packUnorm4x8(shown)));
}

#endif
