// The light of a fragment of the set: its glTF material under all lights, with the shadows of set and performers.
// Declares the bindings that the shaders of opaque, masked and blended pieces share. Bound by fetches from textures and
// shadow maps.
#ifndef NEUVV_SET_SURFACE_GLSL
#define NEUVV_SET_SURFACE_GLSL
#include "arrays.glsl"
#include "shared/set.h"

layout(location = 0) in vec3 shaded_position;
layout(location = 1) in vec3 shaded_normal;
layout(location = 2) in vec4 shaded_tangent;
layout(location = 3) in vec4 shaded_colour;
layout(location = 4) in vec2 shaded_uv;
layout(location = 5) in vec4 shaded_map_uvs_a;
layout(location = 6) in vec4 shaded_map_uvs_b;
layout(binding = kSetBaseTexture) uniform sampler2D base_texture;
layout(binding = kSetMapTextures) uniform sampler2D metallic_roughness_map;
layout(binding = kSetMapTextures + 1u) uniform sampler2D normal_map;
layout(binding = kSetMapTextures + 2u) uniform sampler2D occlusion_map;
layout(binding = kSetMapTextures + 3u) uniform sampler2D emissive_map;
layout(binding = kSetEnvironment) uniform sampler2D environment;
layout(binding = kSetMaterials) uniform textureBuffer materials;
layout(binding = kSetLights) uniform Lights { ShaderLights lights; };
READ_ARRAY(float, kSetShadowMaps, set_shadow_maps);
layout(binding = kSetPerformerShadows) uniform textureBuffer performer_shadows;
layout(push_constant) uniform Push { SetPush push; };

#include "set/environment.glsl"
#include "set/lights.glsl"
#include "set/pbr.glsl"
#include "set/shadow.glsl"

SetMaterial fetch_material(uint index) {
    const int at = int(index * kSetMaterialTexels);
    return SetMaterial(texelFetch(materials, at), texelFetch(materials, at + 1), texelFetch(materials, at + 2),
                       texelFetch(materials, at + 3));
}

vec3 unit_or_up(vec3 v) {
    const float square = dot(v, v);
    return square > 1e-20 ? v * inversesqrt(square) : vec3(0.0, 1.0, 0.0);
}

// The geometric normal on the visible side.
vec3 facing_normal() {
    const vec3 n = unit_or_up(shaded_normal);
    return gl_FrontFacing ? n : -n;
}

// glTF 2.0, 3.9.3. The tangent's w is 0 where there is no normal map. On a back face all three axes are reversed.
vec3 mapped_normal(vec3 geometric, float scale) {
    if (shaded_tangent.w == 0.0) return geometric;
    const vec3 along = shaded_tangent.xyz - dot(shaded_tangent.xyz, geometric) * geometric;
    const float square = dot(along, along);
    if (square < 1e-20) return geometric;
    const float side = gl_FrontFacing ? 1.0 : -1.0;
    const vec3 t = side * along * inversesqrt(square);
    const vec3 b = cross(geometric, t) * (shaded_tangent.w < 0.0 ? -1.0 : 1.0) * side;
    const vec3 local = (texture(normal_map, shaded_map_uvs_a.zw).xyz * 2.0 - 1.0) * vec3(scale, scale, 1.0);
    const vec3 n = t * local.x + b * local.y + geometric * local.z;
    return dot(n, n) > 1e-20 ? normalize(n) : geometric;
}

vec3 lit_surface(SetMaterial material, vec3 base_colour) {
    const vec3 geometric = facing_normal(), to_eye = unit_or_up(push.eye.xyz - shaded_position);
    const vec4 numbers = texture(metallic_roughness_map, shaded_map_uvs_a.xy);
    const Surface surface =
        surface_of(base_colour, clamp(material.surface.x * numbers.b, 0.0, 1.0),
                   clamp(material.surface.y * numbers.g, 0.0, 1.0), mapped_normal(geometric, material.surface.z));
    vec3 light = material.emissive.rgb * texture(emissive_map, shaded_map_uvs_b.zw).rgb;
    for (uint i = 0u; i < lights.count; ++i) {
        vec3 to_light;
        const vec3 arriving = light_at(lights.light[i], shaded_position, to_light);
        const vec3 reflected = arriving * reflect_light(surface, to_eye, to_light);
        if (max(reflected.r, max(reflected.g, reflected.b)) > 0.0)
            light += reflected * set_shadow(i, shaded_position, geometric) * performer_shadow(i, shaded_position, 0.0);
    }
    const vec3 mirrored = reflect(-to_eye, surface.normal);
    vec3 mirrored_light = lights.ambient.rgb;
    if (lights.environment.x > 0.0) mirrored_light += environment_at(mirrored, surface.roughness);
    const float open = 1.0 + material.surface.w * (texture(occlusion_map, shaded_map_uvs_b.xy).r - 1.0);
    const vec3 ambient = ambient_at(lights.irradiance, surface.normal);
    return light + open * reflect_ambient(surface, to_eye, ambient, mirrored_light);
}

vec4 base_colour(SetMaterial material) {
    return material.base_colour * shaded_colour * texture(base_texture, shaded_uv);
}

// The fragment's light, linear and premultiplied.
vec4 shade_fragment(SetMaterial material, vec4 base) {
    const vec3 light = material.emissive.w > 0.0 ? base.rgb : lit_surface(material, base.rgb);
    const float alpha = mix(clamp(base.a, 0.0, 1.0), 1.0, material.alpha.y);
    return vec4(clamp(light, vec3(0.0), vec3(kBrightest)) * alpha, alpha);
}

#endif
