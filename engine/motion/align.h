// Which time of one motion matches which of another: dynamic time warping.
#pragma once

#include <vector>

#include "motion/limb_error.h"

namespace neuvv::motion {

// A motion as what is compared of it, frame by frame.
struct Motion {
    double fps = 25;
    std::vector<Directions> frames;
};
Motion motion_of(const SkeletonClip& clip);
// At a time in frames, which may lie between two; before the first and after the last frame it is theirs.
Directions directions_at(const Motion& motion, double frame);

// For each frame of `performed` the frame of `shown` that it matches, ascending, so that the sum of
// distance() over the path is least. A step along one motion alone costs a little, so that what stands still is not
// warped. Times stay within band_s of the straight line from both beginnings to both ends. The work is
// |performed| × frames of the band. Both motions must have a frame and the same rate (assert).
std::vector<double> warp(const Motion& shown, const Motion& performed, double band_s, bool without_trunk);

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
