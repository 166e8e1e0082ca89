// The ray of one thread: a pixel of its workgroup's tile. The includer binds textureBuffer `cameras` and utextureBuffer
// `tiles`.
#ifndef NEUVV_RAY_GLSL
#define NEUVV_RAY_GLSL

struct Ray {
    uint index;  // of the per-ray buffers
    bool inside; // false: the pixel lies beyond the picture's edge
    vec3 origin_world;
    vec3 direction_world;  // unit
};

// The workgroup's tile. A dispatch of very many tiles rounds their number up: check it against the buffers' end.
uint tile_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

Ray tile_ray() {
    const uint group = tile_group();
    const uvec4 tile = texelFetch(tiles, int(group));
    const uint lane = gl_LocalInvocationID.x;
    const vec2 pixel = vec2(tile.y + lane % kTile, tile.z + lane / kTile);
    const vec2 at = pixel + 0.5 + unpackSnorm2x16(tile.w);
    const int camera = int(4u * tile.x);
    const vec4 right = texelFetch(cameras, camera + 1), down = texelFetch(cameras, camera + 2);
    Ray ray;
    ray.index = group * kTilePixels + lane;
    ray.inside = pixel.x < right.w && pixel.y < down.w;
    ray.origin_world = texelFetch(cameras, camera).xyz;
    ray.direction_world = normalize(texelFetch(cameras, camera + 3).xyz + at.x * right.xyz +
                                    at.y * down.xyz);
    return ray;
}

#endif
