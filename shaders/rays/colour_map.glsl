// Shows numbers as colours of viridis, whose brightness grows monotonically with the number, to colour-blind eyes, too.
#ifndef NEUVV_COLOUR_MAP_GLSL
#define NEUVV_COLOUR_MAP_GLSL
#include "shared/colour_map.h"

// The sRGB colour of a number of 0..1.
vec3 viridis(float at) {
    const vec4 terms[7] = vec4[](kViridis0, kViridis1, kViridis2, kViridis3, kViridis4, kViridis5, kViridis6);
    vec3 sum = terms[6].rgb;
    for (int i = 5; i >= 0; --i) sum = terms[i].rgb + at * sum;
    return clamp(sum, 0.0, 1.0);
}

#endif
