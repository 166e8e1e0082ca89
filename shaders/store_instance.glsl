// A ray's result as one of several instances' (trace_rays.glsl): a layer over or under what earlier ones left, or its segments,
// for merge.comp; or what its walk was like; or alone. kRayOutput says which. An instance of opacity o lets 1 − o (1 − T) of the light through where a solid one lets T.
// The includer binds imageBuffers `radiance` and `depth`, storage buffers `pages` and `heads`, utextureBuffer `sharing`, and what
// shadow.glsl asks for.
#ifndef NEUVV_STORE_INSTANCE_GLSL
#define NEUVV_STORE_INSTANCE_GLSL
#include "layers.glsl"
#include "light_bits.glsl"
#include "lights.glsl"
#include "shadow.glsl"
#include "store_inspected.glsl"

const float kOfOneLux = 0.318309886;  // what a white surface returns of it: 1/π
const float kSelfShadowLift = 0.08;       // metres

// All of the ray's range lies behind something solid. What is left out is less than early termination leaves out.
bool is_hidden(Ray ray) {
    if (kRayOutput == kOutputRay) return false;
    const bool solid = imageLoad(radiance, int(ray.index)).a > 1.0 - push.box_min.w;
    return solid && ((kRayOutput != kOutputLayerByDepth && kRayOutput != kOutputInspect) || imageLoad(depth, int(ray.index)).x < ray.range.x * ray.world_metres);
}

uint first_page = 0u, page = 0u, in_page = 0u;
bool no_room = false;

// Whether the ray is one of a group's: where no other member is seen, a layer is the same for less.
bool is_shared(Ray ray) {
    return kRayOutput == kOutputSegments && texelFetch(sharing, int(ray.index / kTilePixels)).x > 1u;
}

// `next`: the page that follows, or kLastPage | its segments.
void close_page(Ray ray, uint next) {
    const bool first = page == first_page;
    pages[page * kPageWords] = uvec4(next, first ? heads[kFirstHead + ray.index] : 0u, 0u, first ? page * kPageWords + 1u : 0u);
}

// Room for one segment more, in the ray's last page or a new one. False: there is none left, as the number of
// pages that are taken tells.
bool page_has_room(Ray ray) {
    if (page != 0u && in_page < kPageSegments) return true;
    if (no_room) return false;
    const uint fresh = atomicAdd(heads[0], 1u) + 1u;
    no_room = fresh >= uint(pages.length()) / kPageWords;
    if (no_room) return false;
    if (page != 0u) close_page(ray, fresh);
    if (page == 0u) first_page = fresh;
    page = fresh;
    in_page = 0u;
    return true;
}

// `before`, `after`: transmittance of the solid instance.
void store_segment(Ray ray, MarchSegment part, float before, float after, vec3 colour) {
    if (kRayOutput == kOutputInspect) inspect_segment(ray, part, before, after);
    if (!is_shared(ray) || before == after || !page_has_room(ray)) return;
    const float opacity = push.box_size.w;
    const vec2 through = 1.0 - opacity * (1.0 - vec2(before, after));
    const vec2 metres = ray.world_metres * vec2(part.t_in, part.t_out);
    // The solid one's own where it can: no digits are lost then.
    const float depth = opacity == 1.0 ? sigma * (part.t_out - part.t_in) : log(through.x / max(through.y, 1e-30));
    in_page++;
    pages[page * kPageWords + in_page] = uvec4(floatBitsToUint(metres), packHalf2x16(vec2(min(depth, 65504.0), colour.r)),
                                               packHalf2x16(colour.gb));
}

// What the stage's lights make of a place's colour, as if it faced all of them; captured light is what a light of 1 shows.
vec3 light_on(Ray ray, float world_metres) {
    if ((push.lighting & kLit) == 0u) return vec3(1.0);
    const vec3 eye = texelFetch(cameras, int(kCameraTexels * ray.view)).xyz;
    const vec3 world = eye + world_metres * normalize(camera_line(ray.view, ray.at));
    vec3 sum = lights.irradiance[0].rgb;
    for (uint i = 0u; i < lights.count; i++) {
        vec3 to_light;
        const vec3 light = light_at(lights.light[i], world, to_light) * kOfOneLux;
        if (max(light.r, max(light.g, light.b)) <= 0.0) continue;
        const bool shadowed = (push.lighting & kShadowed) != 0u;
        sum += light * (shadowed ? set_shadow(i, world, vec3(0.0)) * performer_shadow(i, world, kSelfShadowLift) : 1.0);
    }
    return sum;
}

void store_ray(Ray ray, vec4 light, float metres, uint steps) {
    if (kRayOutput == kOutputRay) {
        imageStore(radiance, int(ray.index), light);
        imageStore(depth, int(ray.index), vec4(metres));
        return;
    }
    if (kRayOutput == kOutputInspect) {
        store_inspected(ray, light.a, steps);
        return;
    }
    const float world_metres = metres * ray.world_metres;
    if (is_shared(ray)) {
        if (page == 0u) return;
        close_page(ray, kLastPage | in_page);
        pages[first_page * kPageWords].z = bits_of_light(light_on(ray, world_metres));
        heads[kFirstHead + ray.index] = first_page;
        return;
    }
    if (light.a > 0.0) light.rgb *= light_on(ray, world_metres);
    light *= push.box_size.w;
    if (kRayOutput == kOutputLayerByDepth)
        store_by_depth(int(ray.index), light, world_metres);
    else
        store_under(int(ray.index), light, world_metres);
}

#endif
