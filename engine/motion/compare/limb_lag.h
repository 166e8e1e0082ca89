// Whether a limb does the right thing at the wrong time.
#pragma once

#include <optional>
#include <span>

#include "motion/compare/align.h"

namespace neuvv::motion {

// Frames of a trainee, with the frames of the trainer that they match.
struct Matched {
    const Motion& trainer;
    std::span<const double> trainer_frame;
    std::span<const Directions> trainee;

    size_t size() const { return trainee.size(); }
    Directions trainer_at(size_t frame, double later_s = 0) const {
        return directions_at(trainer, trainer_frame[frame] - later_s * trainer.fps);
    }
    Matched part(size_t first, size_t last) const {
        return {trainer, trainer_frame.subspan(first, last - first + 1), trainee.subspan(first, last - first + 1)};
    }
};

// By how many seconds the limb is late (negative: early), at most band_s and 2 s, where that says more than that it
// points elsewhere all the time: README.md has the conditions.
std::optional<double> lag_of(const Matched& frames, Limb limb, double band_s, double tolerance_deg);

}  // namespace neuvv::motion
