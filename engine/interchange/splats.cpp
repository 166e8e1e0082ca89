#include "interchange/splats.h"

#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "media/image.h"

namespace neuvv::interchange {

namespace {

constexpr size_t kSplatsOfPart = 1024;

// The first sh_count(3) harmonics of a unit direction, as shaders/sh.glsl has them.
std::array<float, kMaxShCount> harmonics(const glm::vec3& d) {
    return {0.28209479f,
            0.48860251f * d.y,
            0.48860251f * d.z,
            0.48860251f * d.x,
            1.09254843f * d.x * d.y,
            1.09254843f * d.y * d.z,
            0.31539157f * (3 * d.z * d.z - 1),
            1.09254843f * d.x * d.z,
            0.54627422f * (d.x * d.x - d.y * d.y),
            0.59004359f * d.y * (3 * d.x * d.x - d.y * d.y),
            2.89061144f * d.x * d.y * d.z,
            0.45704580f * d.y * (5 * d.z * d.z - 1),
            0.37317633f * d.z * (5 * d.z * d.z - 3),
            0.45704580f * d.x * (5 * d.z * d.z - 1),
            1.44530572f * d.z * (d.x * d.x - d.y * d.y),
            0.59004359f * d.x * (d.x * d.x - 3 * d.y * d.y)};
}

// Condon-Shortley: harmonics of odd m change their sign.
constexpr std::array<float, kMaxShCount> kPhase = {1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1};

struct Direction {
    std::array<float, kMaxShCount> of_volume,
        of_splats;  // the harmonics of the same direction before and after it is placed
    float weight;   // of a quadrature over the sphere; all weights sum to 4π
};

// Lebedev's 26 directions: exact for polynomials of degree 7.
std::vector<Direction> directions(const glm::dquat& rotation) {
    std::vector<Direction> all;
    for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++)
            for (int z = -1; z <= 1; z++) {
                const int length2 = x * x + y * y + z * z;
                if (length2 == 0) continue;
                constexpr float kWeights[] = {0, 1 / 21.0f, 4 / 105.0f, 9 / 280.0f};
                const glm::dvec3 d = glm::normalize(glm::dvec3(x, y, z));
                Direction direction{harmonics(glm::vec3(d)), harmonics(glm::vec3(rotation * d)),
                                    4 * std::numbers::pi_v<float> * kWeights[length2]};
                for (size_t i = 0; i < kMaxShCount; i++) direction.of_splats[i] *= kPhase[i];
                all.push_back(direction);
            }
    return all;
}

// The colours of a leaf in sRGB, projected onto harmonics of the same degree.
SplatColour splat_colour(const voctree::LeafColours& k, uint32_t degree, const std::vector<Direction>& directions) {
    const uint32_t count = sh_count(degree);
    SplatColour colour{};
    for (int c = 0; c < 3; c++) {
        const std::array<float, kMaxShCount>& channel = k[static_cast<size_t>(c)];
        for (const Direction& direction : directions) {
            float logit = 0;
            for (uint32_t i = 0; i < count; i++) logit += channel[i] * direction.of_volume[i];
            const double linear = 1 / (1 + std::exp(-double{logit}));
            const float shown = static_cast<float>(media::srgb_from_linear(linear)) - 0.5f;
            for (uint32_t i = 0; i < count; i++) colour[i][c] += direction.weight * direction.of_splats[i] * shown;
        }
    }
    return colour;
}

}  // namespace

Splats splats_of(const FrameVolume& volume, const SplatShape& shape, const Placement& to) {
    const std::vector<Direction> all = directions(to.rotation);
    Splats splats{volume.degree, to.rotation, std::vector<Splat>(volume.leaves.size())};
    reshape(splats, volume, shape);
    parallel_for(splats.splats.size(), kSplatsOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) {
            Splat& splat = splats.splats[i];
            splat.centre =
                glm::vec3(to.scale * (to.rotation * glm::dvec3(volume.centre_m(volume.leaves[i]))) + to.offset);
            splat.deviation *= static_cast<float>(to.scale);
            splat.colour = splat_colour(volume.leaves[i].colours, volume.degree, all);
        }
    });
    return splats;
}

void reshape(Splats& splats, const FrameVolume& volume, const SplatShape& shape) {
    for (size_t i = 0; i < splats.splats.size(); i++) {
        const VolumeLeaf& leaf = volume.leaves[i];
        splats.splats[i].deviation = static_cast<float>(shape.width) * volume.edges_m(leaf);
        splats.splats[i].opacity = 1 - std::exp(-static_cast<float>(shape.density) * volume.optical_depth(leaf));
    }
}

}  // namespace neuvv::interchange
