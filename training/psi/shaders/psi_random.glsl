// Random numbers in [0, 1) without state: a hash of (seed, ray, sample) (Jarzynski and Olano 2020, PCG).
#ifndef NEUVV_PSI_RANDOM_GLSL
#define NEUVV_PSI_RANDOM_GLSL

uint pcg(uint value) {
    const uint state = value * 747796405u + 2891336453u;
    const uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return word >> 22u ^ word;
}

float random_at(uint seed, uint ray, uint i) {
    return float(pcg(pcg(pcg(seed) + ray) + i) >> 8u) * (1.0 / 16777216.0);
}

#endif
