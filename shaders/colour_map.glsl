// Numbers as colours: viridis, in which what is more looks brighter all the way, to colour-blind eyes, too.
#ifndef NEUVV_COLOUR_MAP_GLSL
#define NEUVV_COLOUR_MAP_GLSL

// sRGB of 0..1: the polynomials of degree 6 that stay nearest to matplotlib's table (S. van der Walt, N. Smith; CC0), 3 steps of
// 255 at most.
vec3 viridis(float at) {
    const vec3 terms[7] = vec3[](vec3(0.2769, 0.0038, 0.3377), vec3(-0.1374, 1.4892, 0.9541), vec3(2.0837, -0.7281, 5.1219),
                                 vec3(-13.1681, -2.0212, -40.5236), vec3(20.1448, 7.3047, 97.2847),
                                 vec3(-5.8875, -7.9009, -101.2765), vec3(-2.3292, 2.7574, 38.2373));
    vec3 sum = terms[6];
    for (int i = 5; i >= 0; i--) sum = terms[i] + at * sum;
    return clamp(sum, 0.0, 1.0);
}

#endif
