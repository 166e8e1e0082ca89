// Comparison of two motions (engine/motion/README.md), written once more from its formulas.
#pragma once

#include <string>
#include <vector>

#include "motion/skeleton/skeleton.h"

namespace neuvv::reference {

// The error of a limb, degrees: e = √(Σ w θ² / Σ w). −1 where no bone is known in both.
double limb_error(const motion::Pose& a, const motion::Pose& b, motion::Limb limb);

// The least cost of matching all of `a` with all of `b`: `distances` has a row for each frame of b. A step along one of
// them alone costs `step`.
double least_cost(const std::vector<std::vector<double>>& distances, double step);

}  // namespace neuvv::reference
