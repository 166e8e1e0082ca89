// Real spherical harmonics Y_lm of a unit direction, index l² + l + m, polar axis z, no Condon-Shortley phase (errata
// 3).
#ifndef NEUVV_SH_GLSL
#define NEUVV_SH_GLSL

// Functions of degrees beyond kHhDegree are 0.
float[kMaxShCount] sh_basis(vec3 d) {
    float y[kMaxShCount];
    for (uint i = 0u; i < kMaxShCount; ++i) y[i] = 0.0;
    y[0] = 0.28209479;
    if (kHhDegree >= 1u) {
        y[1] = 0.48860251 * d.y;
        y[2] = 0.48860251 * d.z;
        y[3] = 0.48860251 * d.x;
    }
    if (kHhDegree >= 2u) {
        y[4] = 1.09254843 * d.x * d.y;
        y[5] = 1.09254843 * d.y * d.z;
        y[6] = 0.31539157 * (3.0 * d.z * d.z - 1.0);
        y[7] = 1.09254843 * d.x * d.z;
        y[8] = 0.54627422 * (d.x * d.x - d.y * d.y);
    }
    if (kHhDegree >= 3u) {
        y[9] = 0.59004359 * d.y * (3.0 * d.x * d.x - d.y * d.y);
        y[10] = 2.89061144 * d.x * d.y * d.z;
        y[11] = 0.45704580 * d.y * (5.0 * d.z * d.z - 1.0);
        y[12] = 0.37317633 * d.z * (5.0 * d.z * d.z - 3.0);
        y[13] = 0.45704580 * d.x * (5.0 * d.z * d.z - 1.0);
        y[14] = 1.44530572 * d.z * (d.x * d.x - d.y * d.y);
        y[15] = 0.59004359 * d.x * (d.x * d.x - 3.0 * d.y * d.y);
    }
    return y;
}

#endif
