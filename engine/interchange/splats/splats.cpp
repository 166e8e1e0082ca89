#include "interchange/splats/splats.h"

#include <cmath>

#include "base/sigmoid.h"
#include "base/threads/parallel.h"
#include "media/image.h"
#include "voctree/sh_weights.h"

namespace neuvv::interchange {

namespace {

constexpr size_t kSplatsOfPart = 1024;

// Condon-Shortley: harmonics of odd m change their sign.
constexpr std::array<float, kMaxShCount> kPhase = {1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1};

// A direction of a quadrature over the sphere, with the harmonics of it before and after it is turned.
struct Direction {
    std::array<float, kMaxShCount> of_volume, of_splats;
    float weight;
};

std::vector<Direction> directions(const glm::dquat& rotation) {
    std::vector<Direction> all;
    for (const voctree::ShDirection& from : voctree::sh_directions()) {
        const auto before = voctree::sh_basis(from.d), after = voctree::sh_basis(rotation * from.d);
        Direction& direction = all.emplace_back();
        direction.weight = static_cast<float>(from.weight);
        for (size_t i = 0; i < kMaxShCount; ++i) {
            direction.of_volume[i] = static_cast<float>(before[i]);
            direction.of_splats[i] = kPhase[i] * static_cast<float>(after[i]);
        }
    }
    return all;
}

// The colours of a leaf in sRGB, projected onto harmonics of the same degree.
SplatColour splat_colour(const slice::Colours& k, uint32_t degree, const std::vector<Direction>& directions) {
    const uint32_t count = sh_count(degree);
    SplatColour colour{};
    for (int c = 0; c < 3; ++c) {
        const std::array<float, kMaxShCount>& channel = k[static_cast<size_t>(c)];
        for (const Direction& direction : directions) {
            float logit = 0;
            for (uint32_t i = 0; i < count; ++i) logit += channel[i] * direction.of_volume[i];
            const double linear = sigmoid(double{logit});
            const float shown = static_cast<float>(media::srgb_from_linear(linear)) - 0.5f;
            for (uint32_t i = 0; i < count; ++i) colour[i][c] += direction.weight * direction.of_splats[i] * shown;
        }
    }
    return colour;
}

}  // namespace

Splats splats_of(const slice::Slice& volume, const SplatShape& shape, const glm::dquat& rotation) {
    const std::vector<Direction> all = directions(rotation);
    Splats splats{volume.degree, std::vector<Splat>(volume.leaves.size())};
    reshape(splats, volume, shape);
    parallel_for(splats.splats.size(), kSplatsOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            Splat& splat = splats.splats[i];
            splat.rotation = glm::quat(rotation);
            splat.centre = glm::vec3(rotation * glm::dvec3(volume.centre_m(volume.leaves[i])));
            splat.colour = splat_colour(volume.leaves[i].colours, volume.degree, all);
        }
    });
    return splats;
}

void turn(Splats& splats, const glm::dquat& rotation) {
    const std::vector<Direction> all = directions(rotation);
    parallel_for(splats.splats.size(), kSplatsOfPart, [&](size_t begin, size_t end) {
        for (size_t s = begin; s < end; ++s) {
            Splat& splat = splats.splats[s];
            splat.centre = glm::vec3(rotation * glm::dvec3(splat.centre));
            splat.rotation = glm::quat(rotation * glm::dquat(splat.rotation));
            SplatColour turned{};
            for (const Direction& direction : all) {
                glm::vec3 shown(0);
                for (uint32_t i = 0; i < sh_count(splats.degree); ++i)
                    shown += kPhase[i] * direction.of_volume[i] * splat.colour[i];
                for (uint32_t i = 0; i < sh_count(splats.degree); ++i)
                    turned[i] += direction.weight * direction.of_splats[i] * shown;
            }
            splat.colour = turned;
        }
    });
}

void reshape(Splats& splats, const slice::Slice& volume, const SplatShape& shape) {
    for (size_t i = 0; i < splats.splats.size(); ++i) {
        const slice::Leaf& leaf = volume.leaves[i];
        splats.splats[i].deviation = static_cast<float>(shape.width) * volume.edges_m(leaf);
        splats.splats[i].opacity = 1 - std::exp(-static_cast<float>(shape.density) * volume.optical_depth(leaf));
    }
}

}  // namespace neuvv::interchange
