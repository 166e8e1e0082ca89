// Stores a ray's result where a frame has several instances (trace_rays.glsl), as kRayOutput says: as a layer over or
// under what earlier instances stored, as intervals for merge.comp, as statistics of the walk, or alone. An instance of
// opacity o lets 1 − o (1 − T) of the light through where one of opacity 1 lets T through. The includer declares
// the arrays `radiance` and `depth`, storage buffers `pages` and `heads`, utextureBuffer `sharing`, and what
// shadow.glsl needs.
#ifndef NEUVV_STORE_INSTANCE_GLSL
#define NEUVV_STORE_INSTANCE_GLSL
#include "arrays.glsl"
#include "trace/layers.glsl"
#include "trace/light_bits.glsl"
#include "set/lights.glsl"
#include "set/shadow.glsl"
#include "trace/store_inspected.glsl"

const float kRadiancePerLux = 0.318309886;  // of a white diffuse surface: 1/π
const float kSelfShadowLift = 0.08;         // metres, performer_shadow's `lift` for performers
const float kSurfaceAlpha = 0.1;            // the ray has met the surface where it comes to this

// Whether the whole range of the ray is hidden by what earlier instances stored. The error is smaller than that of
// early termination.
bool is_hidden(Ray ray) {
    if (kRayOutput == kOutputRay) return false;
    const bool solid = LOAD(radiance, int(ray.index)).a > 1.0 - push.box_min.w;
    const bool by_depth = kRayOutput == kOutputLayerByDepth || kRayOutput == kOutputInspect;
    return solid && (!by_depth || LOAD(depth, int(ray.index)).x < ray.range.x * ray.world_metres);
}

uint first_page = 0u, page = 0u, in_page = 0u;
bool no_room = false;
float surface_t = -1.0;  // in the centre of the interval where the ray meets the surface; < 0 before it does

// Whether another instance of the group may cover the ray's tile. Elsewhere a layer gives the same result at a lower
// cost than intervals.
bool is_shared(Ray ray) {
    return kRayOutput == kOutputIntervals && texelFetch(sharing, int(ray.index / kTilePixels)).x > 1u;
}

// Writes a page's header. `next` is the next page, or kLastPage | the number of intervals in this page.
void close_page(Ray ray, uint next) {
    const bool first = page == first_page;
    const uint before = first ? heads[kFirstHead + ray.index] : 0u, begin = first ? page * kPageWords + 1u : 0u;
    pages[page * kPageWords] = uvec4(next, before, 0u, begin);
}

// Makes room for one more interval in the ray's last page or in a new one. Returns false where no page is left;
// heads[0], the number of pages taken, then exceeds the number that exist.
bool page_has_room(Ray ray) {
    if (page != 0u && in_page < kPageIntervals) return true;
    if (no_room) return false;
    const uint new_page = atomicAdd(heads[0], 1u) + 1u;
    no_room = new_page >= uint(pages.length()) / kPageWords;
    if (no_room) return false;
    if (page != 0u) close_page(ray, new_page);
    if (page == 0u) first_page = new_page;
    page = new_page;
    in_page = 0u;
    return true;
}

// `before` and `after` are the transmittance before and after the interval, for an instance of opacity 1.
void store_interval(Ray ray, MarchInterval part, float before, float after, vec3 colour) {
    if (kRayOutput == kOutputInspect) inspect_interval(ray, part, before, after);
    if (surface_t < 0.0 && after < 1.0 - kSurfaceAlpha) surface_t = 0.5 * (part.t_in + part.t_out);
    if (!is_shared(ray) || before == after || !page_has_room(ray)) return;
    const float opacity = push.box_size.w;
    const vec2 through = 1.0 - opacity * (1.0 - vec2(before, after));
    const vec2 metres = ray.world_metres * vec2(part.t_in, part.t_out);
    // At opacity 1 the optical depth is computed without the logarithm, which would lose digits.
    const float depth = opacity == 1.0 ? sigma * (part.t_out - part.t_in) : log(through.x / max(through.y, 1e-30));
    ++in_page;
    pages[page * kPageWords + in_page] = uvec4(floatBitsToUint(metres),
                                               packHalf2x16(vec2(min(depth, 65504.0), colour.r)),
                                               packHalf2x16(colour.gb));
}

// The factor by which the stage's lights change the colour at a distance along the ray, as if a surface there faced all
// of them. A captured colour is taken to be lit by a light of 1. Shadow is looked up where the ray meets the surface:
// the distance is a mean along the ray, and that of a ray which also sees through to the back lies inside the
// performer, in its own shadow.
vec3 light_on(Ray ray, float distance_m) {
    if ((push.lighting & kLit) == 0u) return vec3(1.0);
    const vec3 eye = texelFetch(cameras, int(kCameraTexels * ray.view)).xyz;
    const vec3 direction = normalize(camera_line(ray.view, ray.at));
    const vec3 world = eye + distance_m * direction;
    const vec3 seen = surface_t < 0.0 ? world : eye + surface_t * ray.world_metres * direction;
    vec3 sum = lights.irradiance[0].rgb;
    for (uint i = 0u; i < lights.count; ++i) {
        vec3 to_light;
        const vec3 light = light_at(lights.light[i], world, to_light) * kRadiancePerLux;
        if (max(light.r, max(light.g, light.b)) <= 0.0) continue;
        const bool shadowed = (push.lighting & kShadowed) != 0u;
        sum += light * (shadowed ? set_shadow(i, seen, vec3(0.0)) * performer_shadow(i, seen, kSelfShadowLift) : 1.0);
    }
    return sum;
}

void store_ray(Ray ray, vec4 light, float metres, uint steps) {
    if (kRayOutput == kOutputRay) {
        STORE(radiance, int(ray.index), light);
        STORE(depth, int(ray.index), vec4(metres));
        return;
    }
    if (kRayOutput == kOutputInspect) {
        store_inspected(ray, light.a, steps);
        return;
    }
    const float distance_m = metres * ray.world_metres;
    if (is_shared(ray)) {
        if (page == 0u) return;
        close_page(ray, kLastPage | in_page);
        pages[first_page * kPageWords].z = bits_of_light(light_on(ray, distance_m));
        heads[kFirstHead + ray.index] = first_page;
        return;
    }
    if (light.a > 0.0) light.rgb *= light_on(ray, distance_m);
    light *= push.box_size.w;
    if (kRayOutput == kOutputLayerByDepth)
        store_by_depth(int(ray.index), light, distance_m);
    else
        store_under(int(ray.index), light, distance_m);
}

#endif
