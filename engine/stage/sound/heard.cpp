#include "stage/sound/heard.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace neuvv::stage {

namespace {

using media::kSoundHop;
using media::kSoundRate;

constexpr double kStep_s = 1e-3;            // over which the clip's speed is found
constexpr int64_t kNearby = 8 * kSoundHop;  // farther away, a grain is another place of the sound
constexpr int64_t kCoarse = 4;              // of so many samples, one is compared

// Rises over the first hop of a grain and falls over the second; both together are 1.
float window(size_t at) {
    const double s = std::sin(std::numbers::pi * (static_cast<double>(at) + 0.5) / (2 * kSoundHop));
    return static_cast<float>(s * s);
}

}  // namespace

Heard::Heard(const media::Sound& sound, Timeline timeline, double begin_s, double speed)
    : sound_(sound), timeline_(std::move(timeline)), begin_s_(begin_s), speed_(speed) {
    before_ = grain_at(0);
}

// The grain whose centre is so long after the beginning.
Heard::Grain Heard::grain_at(double heard_s) const {
    const auto place_s = [&](double t) { return clip_position(timeline_, begin_s_ + speed_ * t) / timeline_.fps; };
    const double here = place_s(heard_s), next = place_s(heard_s + kStep_s);
    double speed = (next - here) / kStep_s;
    if (std::abs(speed) > kMostHeardSpeed)
        speed = (here - place_s(heard_s - kStep_s)) / kStep_s;  // it is about to jump
    if (std::abs(speed) < kLeastHeardSpeed || std::abs(speed) > kMostHeardSpeed) return {};
    const int step = speed > 0 ? 1 : -1;
    return {std::llround(here * kSoundRate) - step * int64_t{kSoundHop}, step};
}

media::StereoSample Heard::sample(const Grain& grain, size_t at) const {
    const int64_t index = grain.first + grain.step * static_cast<int64_t>(at);
    if (grain.step == 0 || index < 0 || index >= std::ssize(sound_.samples)) return {};
    const auto& both = sound_.samples[static_cast<size_t>(index)];
    return {static_cast<float>(both[0]) / 32768, static_cast<float>(both[1]) / 32768};
}

// How alike the first hops of two grains are: −1 to 1.
double Heard::likeness(const Grain& a, const Grain& b) const {
    double product = 0, of_a = 0, of_b = 0;
    for (size_t i = 0; i < kSoundHop; i += kCoarse) {
        const media::StereoSample x = sample(a, i), y = sample(b, i);
        const double p = double{x[0]} + double{x[1]}, q = double{y[0]} + double{y[1]};
        product += p * q;
        of_a += p * p;
        of_b += q * q;
    }
    return product / std::sqrt(of_a * of_b + 1e-12);
}

Heard::Grain Heard::aligned(Grain grain) const {
    if (grain.step == 0 || grain.step != before_.step) return grain;
    Grain natural = before_;
    natural.first += before_.step * int64_t{kSoundHop};
    const int64_t apart = grain.first - natural.first;
    if (std::abs(apart) <= 1) return natural;  // it differs by rounding
    if (std::abs(apart) > kNearby) return grain;
    Grain best = grain;
    double most = likeness(natural, grain);
    constexpr int64_t kReach = kSoundHop / 2;
    for (int64_t moved = kCoarse; moved <= kReach; moved += kCoarse)  // the least move of those that are as good
        for (const int64_t by : {moved, -moved}) {
            const Grain tried{grain.first + by, grain.step};
            const double like = likeness(natural, tried);
            if (like <= most) continue;
            most = like;
            best = tried;
        }
    return best;
}

void Heard::add_hop(std::array<media::StereoSample, kSoundHop>& samples, float gain) {
    ++hops_;
    const Grain grain = aligned(grain_at(static_cast<double>(hops_ * kSoundHop) / kSoundRate));
    for (size_t i = 0; i < kSoundHop; ++i) {
        const media::StereoSample out = sample(before_, kSoundHop + i), in = sample(grain, i);
        for (size_t side = 0; side < 2; ++side)
            samples[i][side] += gain * (window(kSoundHop + i) * out[side] + window(i) * in[side]);
    }
    before_ = grain;
}

}  // namespace neuvv::stage
