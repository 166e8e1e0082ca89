// What a trainee does otherwise than the trainer, after the fact: by limb, amount and time.
#pragma once

#include <string>
#include <vector>

#include "motion/compare/align.h"

namespace neuvv::motion {

struct CompareOptions {
    Tolerances tolerances;
    double band_s = 1;                                            // how far the trainee may be ahead or behind
    std::vector<bool> counted = std::vector<bool>(kLimbs, true);  // limbs that are compared
};

enum class MistakeKind {
    kOff,       // the limb points elsewhere, by `amount` degrees
    kLate,      // the limb does the same `amount` seconds later (negative: earlier)
    kMirrored,  // the trunk is turned to the other side, by `amount` degrees
};

struct Mistake {
    Limb limb = Limb::kTrunk;
    MistakeKind kind = MistakeKind::kOff;
    double amount = 0;
    double first_s = 0, last_s = 0;  // trainer's time
};
// "left arm: 25° off from 1.0 s to 2.0 s", "right leg: 0.40 s late from …".
std::string text_of(const Mistake& mistake);

// Frames of the trainee, at the trainer's rate.
struct Comparison {
    double fps = 25;
    std::vector<double> trainer_frame;         // which frame of the trainer each matches
    std::vector<LimbErrors> errors;            // degrees, −1 unknown
    std::vector<double> scores;                // by frame, 0..1, over all limbs; −1 where none is known
    std::vector<Mistake> mistakes;             // by time, then by limb
    std::array<double, kLimbs> limb_scores{};  // 0..100, −1 where never known
    double score = -1;                         // 0..100
    double yaw = 0;                            // by which the trainee stood turned, radians
};

// Compares two motions of the same phrase. The trainee may stand elsewhere, turned otherwise, have other proportions
// and another rate; its estimated joints count as unknown. Throws InputError where no limb is known in both.
Comparison compare(const SkeletonClip& trainer, const SkeletonClip& trainee, const CompareOptions& options = {});

// The clip at another rate, its poses mixed (pose_at). Throws InputError for more than kMaxSkeletonFrames.
SkeletonClip resampled(const SkeletonClip& clip, double fps);

}  // namespace neuvv::motion
