// The space of motions that other programs wrote: which axis is up, and how long a unit is.
#pragma once

#include <optional>
#include <string>

#include "motion/skeleton/skeleton.h"

namespace neuvv::motion {

enum class Axis : uint8_t { kX, kMinusX, kY, kMinusY, kZ, kMinusZ };
constexpr std::array<const char*, 6> kAxisNames = {"x", "-x", "y", "-y", "z", "-z"};

// What is known of a motion's space; the rest is found out by the body.
struct MotionSpace {
    std::optional<Axis> up;  // as the user says
    bool y_is_up = false;    // as the format says, whatever the body does
    double unit_m = 0;       // metres of a unit; 0: not known
    double height_m = 0;     // the body's; 0: as the unit says. It wins over the unit
};

// The axis along which the body stands in most frames; nothing where it lies or turns over.
std::optional<Axis> standing_axis(const SkeletonClip& clip);

// The unit in which a body of this height is likeliest, metres: millimetres, centimetres or metres of anybody from a
// child of a year to a giant, else inches or the unit of CMU's motions, else what makes the body nearest to 1.7 m.
double likely_unit(double height);

// Brings a motion to metres and +Y up, and notes what was found out by the body, and what is odd. Throws InputError
// where a body without height has no unit.
void bring_to_metres(const MotionSpace& space, const std::string& file, SkeletonClip& clip);

}  // namespace neuvv::motion
