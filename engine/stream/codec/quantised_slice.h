// A slice: what a clip shows at one of its frames, as the stream sends it. Its leaves have an opacity and colours that
// are spherical harmonics, and nothing of the bases that these came from.
#pragma once

#include <cstdint>
#include <vector>

namespace neuvv::stream {

// All values are in units of 1 / kUnit.
constexpr int kUnit = 1023;
constexpr uint32_t kMaxDepth = 12;
constexpr uint32_t kMaxDegree = 3;

// A plane is one number of every leaf. Plane 0 is the opacity along a leaf's edge, 1 − exp(−σ · edge). Then come three
// planes (kLuma, kOrange, kGreen) for every spherical harmonic, l² + l + m: of 0, they are the colour in sRGB at the
// mean over all directions; of others, by how much the harmonic's largest value changes that.
constexpr uint32_t kOpacityPlane = 0, kFirstColourPlane = 1;
constexpr uint32_t kPlanesOfMean = 4;  // the opacity, and the colour of harmonic 0
constexpr uint32_t planes_of(uint32_t degree) {
    return 1 + 3 * (degree + 1) * (degree + 1);
}

// The colours of three planes: Y = G/2 + (R + B)/4, Co = R − B, Cg = G − (R + B)/2.
struct Ycc {
    float y, co, cg;
};
struct Rgb {
    float r, g, b;
};
constexpr Ycc ycc_of(const Rgb& c) {
    const float co = c.r - c.b, t = c.b + co / 2, cg = c.g - t;
    return {t + cg / 2, co, cg};
}
constexpr Rgb rgb_of(const Ycc& c) {
    const float t = c.y - c.cg / 2, b = t - c.co / 2;
    return {b + c.co, c.cg + t, b};
}

struct Leaf {
    uint64_t cell = 0;   // Morton code of its first cell at the finest depth; z is the highest of three bits
    uint32_t depth = 0;  // 1 to the slice's depth
    bool operator==(const Leaf&) const = default;
};

struct QuantisedSlice {
    uint32_t depth = 2;  // the finest depth that leaves may have
    uint32_t degree = 0;
    std::vector<Leaf> leaves;  // in order of their cells; they do not overlap
    std::vector<std::vector<int16_t>> planes;
};

}  // namespace neuvv::stream
