// Which time of one motion matches which of another: dynamic time warping.
#pragma once

#include <vector>

#include "motion/compare/limb_error.h"

namespace neuvv::motion {

// A motion as what is compared of it, frame by frame.
struct Motion {
    double fps = 25;
    std::vector<Directions> frames;
};
Motion motion_of(const SkeletonClip& clip);
// At a time in frames, which may lie between two; before the first and after the last frame it is theirs.
Directions directions_at(const Motion& motion, double frame);

constexpr double kWarpStepCost = 0.004;  // of a step along one motion alone: 1 − cos 5°

struct Warp {
    std::vector<double> frames;  // for each frame of `performed` the frame of `shown` that it matches, ascending
    double cost = 0;             // the sum of distance() and of kWarpStepCost along the path
};

// The path of least cost. Times stay within band_s of the straight line from both beginnings to both ends, or as far
// from it as its steepness needs. Work and memory are the frames of `performed` times those of the band. Both motions
// must have a frame and the same rate (assert). Throws InputError where that is too much.
Warp warp(const Motion& shown, const Motion& performed, double band_s, bool without_trunk);

// The same as frames arrive, without knowing the end. Frames come at the rate of `shown`.
class OnlineWarp {
  public:
    OnlineWarp(const Motion& shown, double band_s);

    // Takes the next frame of what is performed, at the time at which the clip plays, seconds; returns the time of
    // `shown` that it matches, within band_s of that. Where the clip jumps, call reset().
    double add(const Directions& performed, double clip_time_s);
    void reset();

  private:
    const Motion& shown_;
    double band_s_;
    std::vector<double> costs_, next_costs_;  // by frame of `shown`; infinite outside of the band
    bool began_ = false;
};

}  // namespace neuvv::motion
