// The centre of a leaf from its position (Field::leaf_positions). Space and unit are those of the box.
#ifndef NEUVV_LEAF_CENTRE_GLSL
#define NEUVV_LEAF_CENTRE_GLSL

vec3 leaf_centre(uvec2 position, vec3 box_min, vec3 box_size) {
    const float edge = 1.0 / float(1u << (position.y >> 16u));
    const vec3 centre = (vec3(position.x & 0xffffu, position.x >> 16u, position.y & 0xffffu) + 0.5) * edge;
    return box_min + centre * box_size;
}

#endif
