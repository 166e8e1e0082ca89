// What a trainee does otherwise while performing: the same as compare.h, as poses arrive.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "motion/compare/compare.h"
#include "motion/live/one_euro.h"

namespace neuvv::motion {

struct LimbFeedback {
    double error_deg = -1;  // −1: not known
    double late_s = 0;      // where that explains the error; negative: early
    bool wrong = false;     // beyond the tolerance for 0.3 s, until it was within it for 0.3 s
    double red = 0;         // 0..1: how much the limb is coloured; follows `wrong` within 0.3 s
};

struct Feedback {
    std::array<LimbFeedback, kLimbs> limbs;
    double score = -1;          // 0..100 since the beginning; −1 as long as too little is known
    double trainer_time_s = 0;  // which the trainee's pose matches
    double yaw = 0;             // by which the trainee stands turned, radians
};

class LiveComparison {
  public:
    // The trainer must have a frame (assert).
    LiveComparison(const SkeletonClip& trainer, const CompareOptions& options);
    LiveComparison(const LiveComparison&) = delete;
    LiveComparison& operator=(const LiveComparison&) = delete;

    // Takes a pose that was seen at now_s, while the clip shows clip_time_s; both in seconds. Poses whose time is not
    // after the last one's are left out. Where the clip did not advance by a frame, the comparison stays as it was.
    const Feedback& add(const Pose& trainee, double now_s, double clip_time_s);
    const Feedback& feedback() const { return feedback_; }
    // Begins anew, as the clip jumps to another time. The score goes on.
    void jump();

  private:
    void follow(const Pose& trainee, double clip_time_s);
    void face_the_trainer(const Directions& shown, const Directions& done);
    void judge(double step_s);

    CompareOptions options_;
    Motion trainer_;
    PoseFilter filter_;
    OnlineWarp warp_;
    Feedback feedback_;
    // The last second, a frame of the trainer each.
    std::vector<double> trainer_frames_;
    std::vector<Directions> trainee_frames_;
    std::vector<double> yaws_;              // of the phrase so far
    std::array<double, kLimbs> since_s_{};  // how long each limb contradicts its `wrong`
    Pose last_pose_;                        // filtered, at last_clip_s_
    double last_judged_s_ = -INFINITY;
    double last_now_s_ = -INFINITY, last_clip_s_ = -1, sum_ = 0, count_ = 0;
    double judged_s_ = 0;  // in which a limb was known
    size_t frames_ = 0;
};

}  // namespace neuvv::motion
