// The positions of rays in an image. Along each axis the camera defines how many rays there are per pixel: one density
// inside an inset, others beside it (GridAxis). The includer binds textureBuffer `cameras`.
#ifndef NEUVV_GRID_GLSL
#define NEUVV_GRID_GLSL
#include "rays/grid_axis.glsl"

// Axis 0 is x.
GridAxis camera_axis(uint camera, uint axis) {
    const int first = int(kCameraTexels * camera + 4u + 2u * axis);
    return GridAxis(texelFetch(cameras, first), texelFetch(cameras, first + 1));
}

// The direction through a position of a camera's image, of length 1 along the camera's axis.
vec3 camera_line(uint camera, vec2 at) {
    const int first = int(kCameraTexels * camera);
    return texelFetch(cameras, first + 3).xyz + at.x * texelFetch(cameras, first + 1).xyz +
           at.y * texelFetch(cameras, first + 2).xyz;
}

#endif
