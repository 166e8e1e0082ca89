// The report of `neuvv skeleton compare`: what a trainee does otherwise than a trainer.
#pragma once

#include <string>

#include "motion/compare/compare.h"

namespace neuvv::tools {

struct MotionFacts {
    std::string trainer, trainee;  // files
};

// One HTML file: the score, the mistakes, curves of each limb's error, and the worst moment of each mistake as two
// stick figures, seen from where it shows best. It loads nothing; names are escaped.
std::string motion_page(const MotionFacts& facts, const motion::SkeletonClip& trainer,
                        const motion::SkeletonClip& trainee, const motion::Comparison& comparison,
                        const motion::Tolerances& tolerances);

// A line for each frame of the trainee: its time, the trainer's time, the score, and each limb's error in degrees;
// empty where it is unknown.
std::string motion_csv(const motion::Comparison& comparison);

}  // namespace neuvv::tools
