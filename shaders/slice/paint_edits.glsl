// Reads edits of leaves (shared/paint.h). The includer declares the arrays `edits` and `edit_sigmas`,
// binds utextureBuffer `layers`, and has a PaintPush as `push`.
#ifndef NEUVV_PAINT_EDITS_GLSL
#define NEUVV_PAINT_EDITS_GLSL
#include "arrays.glsl"

struct Edit {
    vec3 target;
    float alpha;
    float sigma;  // 1/m; below 0: the density stays
    uint blend;
    float opacity;
};

// Reads an edit; false where it does not apply at push.frame. Frames are compared as the bits of floats, whose order is
// that of the floats where none is negative: an edit may begin just behind frame 0, with a denormal, which devices may
// take for 0.
bool edit_applies(uint index, out Edit edit) {
    const uvec4 words = FETCH(edits, int(index));
    const uint frame = floatBitsToUint(push.frame);
    if (!(words.x <= frame && frame <= words.y)) return false;
    const uint more = FETCH(edit_sigmas, int(index)).x;
    const uvec2 layer = texelFetch(layers, int(more >> 16u)).xy;
    const vec2 red_green = unpackHalf2x16(words.z), blue_alpha = unpackHalf2x16(words.w);
    edit = Edit(vec3(red_green, blue_alpha.x), blue_alpha.y, unpackHalf2x16(more).x, layer.x, uintBitsToFloat(layer.y));
    return true;
}

#endif
