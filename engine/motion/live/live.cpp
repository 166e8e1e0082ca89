#include "motion/live/live.h"

#include <algorithm>
#include <cmath>

#include "motion/compare/limb_lag.h"
#include "motion/skeleton/median.h"

namespace neuvv::motion {

namespace {

constexpr double kWindow_s = 1;         // in which lags are looked for
constexpr double kPhrase_s = 6;         // over which the trainee's direction is the median
constexpr double kReddens_s = 0.3;      // before a limb turns red, or back
constexpr double kRelease = 0.85;       // of the tolerance: what a limb that is wrong must come back to
constexpr double kLongestStep_s = 0.5;  // of the clip between two images, that are filled with poses
constexpr double kLeastJudged_s = 1;    // before there is a score: one pose, or two, are no motion
constexpr double kLeastJudged = 10;     // poses likewise
constexpr size_t kLagFrames = 5;        // between two searches for lags, which take milliseconds

// Keeps the newest `size` values.
template <typename T>
void push(std::vector<T>& values, const T& value, double size) {
    if (static_cast<double>(values.size()) >= size) values.erase(values.begin());
    values.push_back(value);
}

}  // namespace

LiveComparison::LiveComparison(const SkeletonClip& trainer, const CompareOptions& options)
    : options_(options), trainer_(motion_of(trainer)), warp_(trainer_, options.band_s) {}

void LiveComparison::jump() {
    filter_.reset();
    warp_.reset();
    trainer_frames_.clear();
    trainee_frames_.clear();
    last_clip_s_ = -1;
}

const Feedback& LiveComparison::add(const Pose& trainee, double now_s, double clip_time_s) {
    if (now_s <= last_now_s_) return feedback_;
    last_now_s_ = now_s;
    if (!std::isfinite(last_judged_s_)) last_judged_s_ = now_s - 1 / trainer_.fps;
    const Pose filtered = filter_.filter(trainee, now_s);
    const double frame_s = 1 / trainer_.fps;
    if (last_clip_s_ >= 0 && clip_time_s - last_clip_s_ < 0.999 * frame_s && clip_time_s >= last_clip_s_)
        return feedback_;
    // The warp and the window want a pose for each frame of the clip. Where images are fewer, poses between are mixed.
    const double passed_s = last_clip_s_ < 0 ? frame_s : std::clamp(clip_time_s - last_clip_s_, 0.0, kLongestStep_s);
    const auto steps = std::max(1, static_cast<int>(std::lround(passed_s / frame_s)));
    for (int i = 1; i <= steps; ++i) {
        const double share = static_cast<double>(i) / steps;
        const Pose between = last_clip_s_ < 0 ? filtered : mixed(last_pose_, filtered, share);
        follow(between, clip_time_s - (1 - share) * passed_s);
    }
    last_clip_s_ = clip_time_s;
    last_pose_ = filtered;
    judge(std::clamp(now_s - last_judged_s_, 0.0, kLongestStep_s));
    last_judged_s_ = now_s;
    return feedback_;
}

void LiveComparison::follow(const Pose& trainee, double clip_time_s) {
    Directions done = directions_of(trainee);
    for (size_t b = 0; b < kComparedBones; ++b)
        if (!options_.counted[index_of(limb_of_bone(b))]) done[b].weight = 0;
    feedback_.trainer_time_s = warp_.add(done, clip_time_s);
    const double frame = feedback_.trainer_time_s * trainer_.fps;
    face_the_trainer(directions_at(trainer_, frame), done);
    const double window = kWindow_s * trainer_.fps;
    push(trainer_frames_, frame, window);
    push(trainee_frames_, turned(done, -feedback_.yaw), window);
    ++frames_;
}

// How the trainee stands turned, by the phrase so far.
void LiveComparison::face_the_trainer(const Directions& shown, const Directions& done) {
    const double yaw = yaw_between(shown, done);
    if (std::isfinite(yaw)) push(yaws_, yaw, kPhrase_s * trainer_.fps);
    if (!yaws_.empty()) feedback_.yaw = median_angle(yaws_);
}

void LiveComparison::judge(double step_s) {
    const Matched window{trainer_, trainer_frames_, trainee_frames_};
    const LimbErrors errors = limb_errors(window.trainer_at(window.size() - 1), trainee_frames_.back());
    double sum = 0, known = 0;
    for (size_t i = 0; i < kLimbs; ++i) {
        LimbFeedback& limb = feedback_.limbs[i];
        const double tolerance = options_.tolerances.tolerance[i];
        limb.error_deg = errors[i];
        const bool beyond = errors[i] > (limb.wrong ? kRelease : 1) * tolerance;
        since_s_[i] = beyond != limb.wrong ? since_s_[i] + step_s : 0;
        const bool turns = since_s_[i] >= kReddens_s;
        if (turns) limb.wrong = beyond, since_s_[i] = 0;
        limb.red = std::clamp(limb.red + (limb.wrong ? step_s : -step_s) / kReddens_s, 0.0, 1.0);
        if (!limb.wrong)
            limb.late_s = 0;
        else if (turns || frames_ % kLagFrames == 0)
            limb.late_s = lag_of(window, static_cast<Limb>(i), options_.band_s, tolerance).value_or(0);
        if (const double score = limb_score(static_cast<Limb>(i), errors[i], options_.tolerances); score >= 0)
            sum += score, ++known;
    }
    if (known == 0) return;
    sum_ += sum / known;
    ++count_;
    judged_s_ += step_s;
    // Of short clips, half is enough.
    const double half = 0.5 * static_cast<double>(trainer_.frames.size());
    if (count_ >= std::clamp(half, 3.0, kLeastJudged) && judged_s_ >= std::min(kLeastJudged_s, half / trainer_.fps))
        feedback_.score = 100 * sum_ / count_;
}

}  // namespace neuvv::motion
