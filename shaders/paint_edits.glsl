// Reads edits of leaves (shared/paint.h). The includer binds the utextureBuffers `painted_leaves`, `edits`,
// `edit_sigmas` and `layers`, and has a PaintPush as `push`.
#ifndef NEUVV_PAINT_EDITS_GLSL
#define NEUVV_PAINT_EDITS_GLSL

struct Edit {
    vec3 target;
    float alpha;
    float sigma;  // 1/m; below 0: the density stays
    uint blend;
    float opacity;
};

// Reads an edit; false where it does not apply at push.frame.
bool edit_applies(uint index, out Edit edit) {
    const uvec4 words = texelFetch(edits, int(index));
    const vec2 frames = uintBitsToFloat(words.xy);
    if (!(frames.x <= push.frame && push.frame <= frames.y)) return false;
    const uint more = texelFetch(edit_sigmas, int(index)).x;
    const uvec2 layer = texelFetch(layers, int(more >> 16u)).xy;
    const vec2 red_green = unpackHalf2x16(words.z), blue_alpha = unpackHalf2x16(words.w);
    edit = Edit(vec3(red_green, blue_alpha.x), blue_alpha.y, unpackHalf2x16(more).x, layer.x, uintBitsToFloat(layer.y));
    return true;
}

#endif
