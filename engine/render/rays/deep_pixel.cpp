#include "render/rays/deep_pixel.h"

#include <algorithm>
#include <cmath>

namespace neuvv::render {

namespace {

// Where the eye sees `light` before this depth, and `through` of what is behind.
struct DeepKnot {
    float m = 0, through = 1;
    glm::vec3 light{0};
};

// Follows a ray from depth to depth.
class RayReader {
  public:
    explicit RayReader(std::span<const RayStretch> stretches) : stretches_(stretches) {}

    // The depths must not fall from call to call. `behind`: behind the surfaces at this depth, not before them.
    DeepKnot at(float m, bool behind) {
        const auto is_before = [&](const RayStretch& stretch) {
            return stretch.far_m < m || (stretch.far_m == m && (behind || stretch.near_m < m));
        };
        for (; !stretches_.empty() && is_before(stretches_[0]); stretches_ = stretches_.subspan(1)) {
            light_ += stretches_[0].light;
            through_ = stretches_[0].after;
        }
        if (stretches_.empty() || stretches_[0].near_m >= m) return {m, through_, light_};
        const RayStretch& in = stretches_[0];
        const float part = (m - in.near_m) / (in.far_m - in.near_m);
        const float through = in.before * std::pow(in.after / in.before, part);
        return {m, through, light_ + (in.before - through) / (in.before - in.after) * in.light};
    }

  private:
    std::span<const RayStretch> stretches_;
    float through_ = 1;
    glm::vec3 light_{0};
};

// The mean of the rays at these depths, which rise.
std::vector<DeepKnot> mean_at(std::span<const float> depths, std::span<const std::vector<RayStretch>> rays) {
    std::vector<RayReader> readers(rays.begin(), rays.end());
    std::vector<DeepKnot> knots;
    for (const float m : depths)
        for (const bool behind : {false, true}) {
            DeepKnot mean{m, 0};
            for (RayReader& reader : readers) {
                const DeepKnot one = reader.at(m, behind);
                mean.through += one.through / static_cast<float>(rays.size());
                mean.light += one.light / static_cast<float>(rays.size());
            }
            if (!behind || mean.through < knots.back().through) knots.push_back(mean);
        }
    return knots;
}

// At all ends of stretches, and between them where the transmittance falls much, so that samples are compared there,
// too.
std::vector<DeepKnot> mean_of(std::span<const std::vector<RayStretch>> rays) {
    constexpr float kMuch = 1.0f / 64;
    constexpr int kParts = 8;
    std::vector<float> depths;
    for (const std::vector<RayStretch>& ray : rays)
        for (const RayStretch& stretch : ray) depths.insert(depths.end(), {stretch.near_m, stretch.far_m});
    std::sort(depths.begin(), depths.end());
    depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    const std::vector<DeepKnot> ends = mean_at(depths, rays);
    const size_t count = depths.size();
    for (size_t i = 1; i < ends.size(); ++i)
        for (int part = 1; part < kParts && ends[i - 1].through - ends[i].through > kMuch; ++part)
            depths.push_back(glm::mix(ends[i - 1].m, ends[i].m, static_cast<float>(part) / kParts));
    if (depths.size() == count) return ends;
    std::sort(depths.begin(), depths.end());
    depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    return mean_at(depths, rays);
}

// The knots from `first` to `last` as one sample, and the knot between them where that is most wrong.
struct Piece {
    size_t first = 0, last = 0, worst = 0;
    float error = 0;
};

Piece piece_of(std::span<const DeepKnot> knots, size_t first, size_t last) {
    Piece piece{first, last};
    const DeepKnot &from = knots[first], &to = knots[last];
    if (!(from.through > 0)) return piece;
    for (size_t i = first + 1; i < last; ++i) {
        const float part = (knots[i].m - from.m) / (to.m - from.m);
        const float error = std::abs(knots[i].through - from.through * std::pow(to.through / from.through, part));
        if (error > piece.error) piece = {first, last, i, error};
    }
    return piece;
}

media::DeepSample sample_of(const DeepKnot& from, const DeepKnot& to) {
    const glm::vec3 light = (to.light - from.light) / from.through;
    return {from.m, to.m, {light.r, light.g, light.b, 1 - to.through / from.through}};
}

}  // namespace

std::vector<media::DeepSample> deep_samples(std::span<const std::vector<RayStretch>> rays, size_t most) {
    const std::vector<DeepKnot> knots = mean_of(rays);
    if (knots.size() < 2) return {};
    std::vector<Piece> pieces = {piece_of(knots, 0, knots.size() - 1)};
    const auto lets_all_through = [&](const Piece& piece) {
        return knots[piece.last].through >= knots[piece.first].through;
    };
    while (pieces.size() < most + static_cast<size_t>(std::count_if(pieces.begin(), pieces.end(), lets_all_through))) {
        const auto worst = std::max_element(pieces.begin(), pieces.end(),
                                            [](const Piece& a, const Piece& b) { return a.error < b.error; });
        if (worst->error <= kDeepError) break;
        const Piece split = *worst;
        *worst = piece_of(knots, split.first, split.worst);
        pieces.insert(worst + 1, piece_of(knots, split.worst, split.last));
    }
    std::vector<media::DeepSample> samples;
    for (const Piece& piece : pieces)
        if (!lets_all_through(piece)) samples.push_back(sample_of(knots[piece.first], knots[piece.last]));
    return samples;
}

}  // namespace neuvv::render
