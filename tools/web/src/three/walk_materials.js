// The engine's walk (performer.frag) as materials of three.js.
import {BackSide, GLSL3, NoBlending, RawShaderMaterial, UniformsLib, UniformsUtils} from 'three';
import {kStop} from '../slice_tree.js';

// The far sides of the box around the leaves, so that it is drawn also where the eye is inside.
const kVertex = `
uniform mat4 clip_from_tree;
uniform vec3 low, high;  // of the box, metres
in vec3 position;        // of a box that is as large or larger
void main() { gl_Position = clip_from_tree * vec4(clamp(position, low, high), 1); }`;

// What follows the walk, which has left `pixel`, linear and premultiplied, and gl_FragDepth.
const kBegin = `
precision highp float;
precision highp int;
uniform highp vec4 viewport;
uniform highp mat4 view_from_clip;
vec3 view_place() {
    vec2 at = (gl_FragCoord.xy - viewport.xy) / viewport.zw;
    vec4 view = view_from_clip * vec4(2.0 * vec3(at, gl_FragDepth) - 1.0, 1.0);
    return view.xyz / view.w;
}
#include <common>
`;

// The light of the scene's lights, as if a surface faced all of them: three.js gives them as irradiance.
const kLight = `
#define LIT
uniform highp mat4 viewMatrix;
#include <lights_pars_begin>
vec3 light_at(vec3 place) {
    vec3 sum = ambientLightColor;
    IncidentLight light;
#if NUM_POINT_LIGHTS > 0
    for (int i = 0; i < NUM_POINT_LIGHTS; ++i) { getPointLightInfo(pointLights[i], place, light); sum += light.color; }
#endif
#if NUM_SPOT_LIGHTS > 0
    for (int i = 0; i < NUM_SPOT_LIGHTS; ++i) { getSpotLightInfo(spotLights[i], place, light); sum += light.color; }
#endif
#if NUM_DIR_LIGHTS > 0
    for (int i = 0; i < NUM_DIR_LIGHTS; ++i) { getDirectionalLightInfo(directionalLights[i], light); sum += light.color; }
#endif
    return sum * RECIPROCAL_PI;
}`;
const kImage = `
uniform highp float opacity;
uniform bool is_srgb;
void main() {
    walk();
#ifdef LIT
    pixel.rgb *= light_at(view_place());
#endif
    if (is_srgb) pixel.rgb = srgb_encode(pixel.rgb / pixel.a) * pixel.a;
    pixel *= opacity;
}`;

// In shadow maps, a ray that loses half of its light has met a surface.
const kSurface = `
#include <packing>
void surface() {
    walk();
    if (pixel.a < 0.5) discard;
}`;
const kDepth = `${kSurface}
void main() {
    surface();
    pixel = packDepthToRGBA(gl_FragDepth);
}`;
const kDistance = `${kSurface}
uniform highp float near, far;
void main() {
    surface();
    pixel = packDepthToRGBA(clamp((length(view_place()) - near) / (far - near), 0.0, 1.0));
}`;

/** The uniforms of all of them, shared: performer.frag's, and those above. */
export function walkUniforms() {
    const values = {clip_from_tree: [], low: [0, 0, 0], high: [0, 0, 0], tree_links: null, nodes: null, entries: null, viewport: [0, 0, 1, 1],
                    view_from_clip: [], opacity: 1, is_srgb: false, near: 0, far: 1};
    const push = {background: [0, 0, 0, 0], stop: kStop, top: {first: 0, last: 0}, node_base: 0, entry_base: 0, shaded_stride: 0};
    return {...UniformsUtils.clone(UniformsLib.lights),
            ...Object.fromEntries(Object.entries({...values, push}).map(([name, value]) => [name, {value}]))};
}

/** {image, depth, distance}: what is seen; what casts the shadows of spots and suns, and of points. */
export function walkMaterials(walk, uniforms, isLit) {
    const begin = walk.replace('#version 300 es\n', '').replace('void main()', 'void walk()') + kBegin;
    const material = (end, more) => new RawShaderMaterial({glslVersion: GLSL3, vertexShader: kVertex, fragmentShader: begin + end, uniforms,
                                                           side: BackSide, shadowSide: BackSide, toneMapped: false, ...more});
    return {image: material(isLit ? kLight + kImage : kImage, {transparent: true, premultipliedAlpha: true, lights: isLit}),
            depth: material(kDepth, {blending: NoBlending}), distance: material(kDistance, {blending: NoBlending})};
}
