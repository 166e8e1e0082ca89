// The positions of rays along an axis of an image (GridAxis), in pixels.
#ifndef NEUVV_GRID_AXIS_GLSL
#define NEUVV_GRID_AXIS_GLSL

float pixel_of_ray(GridAxis axis, float ray) {
    const vec4 k = axis.knots;
    return ray < k.x ? k.z + (ray - k.x) * axis.slopes.x
                     : ray <= k.y ? k.z + (ray - k.x) * axis.slopes.y : k.w + (ray - k.y) * axis.slopes.z;
}

float ray_of_pixel(GridAxis axis, float pixel) {
    const vec4 k = axis.knots;
    return pixel < k.z ? k.x + (pixel - k.z) / axis.slopes.x
                       : pixel <= k.w ? k.x + (pixel - k.z) / axis.slopes.y : k.y + (pixel - k.w) / axis.slopes.z;
}

#endif
