#include "motion/compare/limb_lag.h"

#include <algorithm>
#include <cmath>

#include "motion/compare/best_turn.h"

namespace neuvv::motion {

namespace {

constexpr double kLeastLag_s = 0.1, kLagStep_s = 0.02, kMostLag_s = 2;
constexpr double kLagGain = 0.6;  // a limb is late where its error at another time is less than this of its own

// The root of the mean square of the limb's error; infinite where it is never known.
template <typename ErrorAt>
double error_over(const Matched& frames, ErrorAt&& error_at) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < frames.size(); ++i)
        if (const double error = error_at(i); error >= 0) sum += error * error, ++count;
    return count > 0 ? std::sqrt(sum / count) : INFINITY;
}

// The trainee compared with `later_s` before.
double error_with_lag(const Matched& frames, Limb limb, double later_s) {
    return error_over(frames, [&](size_t i) {
        return limb_errors(frames.trainer_at(i, later_s), frames.trainee[i])[index_of(limb)];
    });
}

// What is left of the error where all of the limb is turned by one rotation, the best one.
double error_with_turn(const Matched& frames, Limb limb) {
    BestTurn best;
    for (size_t i = 0; i < frames.size(); ++i) {
        const Directions shown = frames.trainer_at(i), &done = frames.trainee[i];
        for (size_t b = 0; b < kComparedBones; ++b)
            if (limb_of_bone(b) == limb)
                best.add(done[b].direction, shown[b].direction, std::min(done[b].weight, shown[b].weight));
    }
    const glm::dmat3 turn = best.turn();
    return error_over(frames, [&](size_t i) {
        Directions done = frames.trainee[i];
        for (BoneDirection& bone : done) bone.direction = turn * bone.direction;
        return limb_errors(frames.trainer_at(i), done)[index_of(limb)];
    });
}

}  // namespace

std::optional<double> lag_of(const Matched& frames, Limb limb, double band_s, double tolerance_deg) {
    const double own = error_with_lag(frames, limb, 0);
    double best = own, lag = 0;
    band_s = std::min(band_s, kMostLag_s);
    for (double later = -band_s; later <= band_s + 1e-9; later += kLagStep_s) {
        const double error = error_with_lag(frames, limb, later);
        if (error < best) best = error, lag = later;
    }
    const bool explains = best < kLagGain * own && best < tolerance_deg;
    if (!explains || std::abs(lag) < kLeastLag_s || error_with_turn(frames, limb) < best) return std::nullopt;
    return lag;
}

}  // namespace neuvv::motion
