#include "motion/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "motion/compare/limb_lag.h"
#include "motion/skeleton/median.h"

namespace neuvv::motion {

namespace {

constexpr double kShortest_s = 0.2;  // of a mistake
constexpr double kSteady_s = 0.3;    // peaks of half of this are noise
constexpr double kGap_s = 0.4;       // within which a mistake goes on
constexpr double kMirrorGain = 0.5;  // a turn is mirrored where the mirrored facing leaves less than this of the error

constexpr double kLeastTurn_deg = 1;  // of some bone, in a motion
constexpr double kLeastKnown = 0.1;   // of the frames: limbs that are known in fewer are not compared

struct Span {
    size_t first = 0, last = 0;  // frames of the trainee
    size_t beyond = 0;           // how many of them are beyond the tolerance
};

class Comparer {
  public:
    Comparer(const SkeletonClip& trainer, const SkeletonClip& trainee, const CompareOptions& options)
        : options_(options), trainer_(motion_of(trainer)), trainee_(motion_of(resampled(trainee, trainer.fps))) {
        if (std::ranges::find(options.counted, true) == options.counted.end())
            throw InputError(Setting{"leave-out"}, "", "leaves no limb to compare", "name fewer limbs");
        // The direction in which the trainee stands would make up for it, and hide it in motions that are symmetric.
        if (faces_backwards(trainer) != faces_backwards(trainee))
            throw InputError("compare", faces_backwards(trainer) ? "TRAINER" : "TRAINEE",
                             "has left and right exchanged: knees, feet or nose point backwards",
                             "exchange them where the motion was made");
    }

    Comparison run() {
        result_.fps = trainer_.fps;
        expect_motion(counted(trainer_), "TRAINER");
        expect_motion(counted_motion(), "TRAINEE");
        // Limbs say when, that says how the trainee stands turned, and with that the trunk helps to say when.
        result_.trainer_frame = warp(trainer_, counted_motion(), options_.band_s, true).frames;
        face_the_trainer();
        result_.trainer_frame = warp(trainer_, counted_motion(), options_.band_s, false).frames;
        face_the_trainer();
        trainee_ = counted_motion();
        measure();
        for (size_t limb = 0; limb < kLimbs; ++limb) find_mistakes(static_cast<Limb>(limb));
        std::ranges::stable_sort(result_.mistakes, {}, &Mistake::first_s);
        score();
        return std::move(result_);
    }

  private:
    size_t frames() const { return trainee_.frames.size(); }
    double error_at(size_t frame, Limb limb) const { return result_.errors[frame][index_of(limb)]; }
    Matched matched() const { return {trainer_, result_.trainer_frame, trainee_.frames}; }
    Directions trainer_at(size_t frame) const { return matched().trainer_at(frame); }

    // A pose that is held is no motion: any time of it matches any other.
    static void expect_motion(const Motion& motion, const char* whose) {
        Directions first{};
        bool known = false;
        for (const Directions& directions : motion.frames)
            for (size_t b = 0; b < kComparedBones; ++b) {
                if (!(directions[b].weight > 0)) continue;
                known = true;
                if (!(first[b].weight > 0)) first[b] = directions[b];
                if (glm::dot(first[b].direction, directions[b].direction) < std::cos(glm::radians(kLeastTurn_deg)))
                    return;
            }
        if (known)
            throw InputError("compare", whose, "holds one pose: there is no motion to compare",
                             "export the file with its motion");
    }

    Motion counted_motion() const { return counted(trainee_); }

    // Without the limbs that do not count.
    Motion counted(Motion motion) const {
        for (Directions& directions : motion.frames)
            for (size_t b = 0; b < kComparedBones; ++b)
                if (!options_.counted[index_of(limb_of_bone(b))]) directions[b].weight = 0;
        return motion;
    }

    // Turns the trainee about +Y, for the whole phrase, so that hips and shoulders point as the trainer's.
    void face_the_trainer() {
        std::vector<double> yaws;
        for (size_t i = 0; i < frames(); ++i) {
            const double yaw = yaw_between(trainer_at(i), trainee_.frames[i]);
            if (std::isfinite(yaw)) yaws.push_back(yaw);
        }
        if (yaws.empty()) return;
        const double yaw = median_angle(std::move(yaws));
        for (Directions& directions : trainee_.frames) directions = turned(directions, -yaw);
        result_.yaw += yaw;
    }

    void measure() {
        std::array<double, kLimbs> known{};  // frames
        for (size_t i = 0; i < frames(); ++i) {
            result_.errors.push_back(limb_errors(trainer_at(i), trainee_.frames[i]));
            for (size_t limb = 0; limb < kLimbs; ++limb) known[limb] += result_.errors.back()[limb] >= 0;
        }
        const auto is_compared = [&](size_t limb) {
            return known[limb] > 0 && known[limb] >= kLeastKnown * static_cast<double>(frames());
        };
        bool any = false, arms_or_legs = false, wanted = false;
        for (size_t limb = 0; limb < kLimbs; ++limb) {
            const bool is_end = limb != index_of(Limb::kTrunk) && limb != index_of(Limb::kHead);
            any |= is_compared(limb);
            arms_or_legs |= is_end && is_compared(limb);
            wanted |= is_end && options_.counted[limb];
            if (is_compared(limb)) continue;
            for (LimbErrors& errors : result_.errors) errors[limb] = -1;
        }
        // Trunks of any two motions agree, and say nothing of what arms and legs do.
        if (!any || (wanted && !arms_or_legs))
            throw InputError("compare", "",
                             any ? "trainer and trainee have no arm and no leg that is measured in both"
                                 : "trainer and trainee have no limb that is measured in both",
                             Remedy::kCountJoints);
    }

    // A limb's error with short peaks taken out: at each frame the median of the frames around it. −1 where unknown.
    std::vector<double> steady_errors(Limb limb) const {
        const auto reach = static_cast<std::ptrdiff_t>(std::lround(0.5 * kSteady_s * trainer_.fps));
        const auto count = static_cast<std::ptrdiff_t>(frames());
        std::vector<double> steady(frames(), -1), around;
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            around.clear();
            for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, i - reach); k <= std::min(count - 1, i + reach); ++k)
                if (const double error = error_at(static_cast<size_t>(k), limb); error >= 0) around.push_back(error);
            if (!around.empty()) steady[static_cast<size_t>(i)] = median(around);
        }
        return steady;
    }

    // Where a limb is wrong: beyond its tolerance for a while.
    std::vector<Span> wrong_spans(Limb limb) const {
        const auto gap = static_cast<size_t>(std::lround(kGap_s * trainer_.fps));
        const double tolerance = options_.tolerances.tolerance[index_of(limb)];
        const std::vector<double> errors = steady_errors(limb);
        std::vector<Span> spans;
        for (size_t i = 0; i < frames(); ++i) {
            if (errors[i] <= tolerance) continue;
            if (spans.empty() || i - spans.back().last > gap) spans.push_back({i, i, 0});
            spans.back().last = i;
            ++spans.back().beyond;
        }
        std::erase_if(spans,
                      [&](const Span& span) { return static_cast<double>(span.beyond) < kShortest_s * trainer_.fps; });
        return spans;
    }

    // Whether the hips turn to the other side of where the trainer's face on the whole.
    bool is_mirrored(const Span& span) const {
        double own = 0, mirrored = 0;
        for (size_t i = span.first; i <= span.last; ++i) {
            const double shown = facing(trainer_at(i)), done = facing(trainee_.frames[i]);
            if (!std::isfinite(shown + done)) continue;
            own += std::pow(std::remainder(done - shown, 2 * std::numbers::pi), 2);
            mirrored += std::pow(std::remainder(done + shown - 2 * centre_, 2 * std::numbers::pi), 2);
        }
        return mirrored < kMirrorGain * kMirrorGain * own;
    }
    // Of the line across the hips, about +Y from the world's +X, radians.
    static double facing(const Directions& directions) {
        const BoneDirection& hips = directions[kHipLine];
        return hips.weight > 0 ? std::atan2(-hips.direction.z, hips.direction.x) : NAN;
    }

    double median_error(Limb limb, const Span& span) const {
        std::vector<double> errors;
        for (size_t i = span.first; i <= span.last; ++i)
            if (error_at(i, limb) >= 0) errors.push_back(error_at(i, limb));
        return median(errors);
    }

    void find_mistakes(Limb limb) {
        if (limb == Limb::kTrunk) {
            std::vector<double> facings;
            for (const Directions& directions : trainer_.frames)
                if (const double angle = facing(directions); std::isfinite(angle)) facings.push_back(angle);
            if (!facings.empty()) centre_ = median_angle(std::move(facings));
        }
        for (const Span& span : wrong_spans(limb)) {
            Mistake mistake{limb, MistakeKind::kOff, median_error(limb, span), 0, 0};
            mistake.first_s = result_.trainer_frame[span.first] / trainer_.fps;
            mistake.last_s = result_.trainer_frame[span.last] / trainer_.fps;
            if (limb == Limb::kTrunk && is_mirrored(span)) {
                mistake.kind = MistakeKind::kMirrored;
            } else if (const auto lag = lag_of(matched().part(span.first, span.last), limb, options_.band_s,
                                               options_.tolerances.tolerance[index_of(limb)])) {
                mistake.kind = MistakeKind::kLate;
                mistake.amount = *lag;
            }
            result_.mistakes.push_back(mistake);
        }
    }

    void score() {
        std::array<double, kLimbs> sums{}, counts{};
        double total = 0, known_frames = 0;
        for (const LimbErrors& errors : result_.errors) {
            double sum = 0, count = 0;
            for (size_t limb = 0; limb < kLimbs; ++limb) {
                const double value = limb_score(static_cast<Limb>(limb), errors[limb], options_.tolerances);
                if (value < 0) continue;
                sums[limb] += value, ++counts[limb];
                sum += value, ++count;
            }
            result_.scores.push_back(count > 0 ? sum / count : -1);
            if (count > 0) total += sum / count, ++known_frames;
        }
        for (size_t limb = 0; limb < kLimbs; ++limb)
            result_.limb_scores[limb] = counts[limb] > 0 ? 100 * sums[limb] / counts[limb] : -1;
        result_.score = known_frames > 0 ? 100 * total / known_frames : -1;
    }

    const CompareOptions& options_;
    Motion trainer_, trainee_;
    double centre_ = 0;  // where the trainer faces on the whole, as facing() says
    Comparison result_;
};

}  // namespace

std::string text_of(const Mistake& mistake) {
    const std::string when = fmt::format("from {:.1f} s to {:.1f} s", mistake.first_s, mistake.last_s);
    const char* limb = kLimbNames[index_of(mistake.limb)];
    switch (mistake.kind) {
        case MistakeKind::kOff:
            return fmt::format("{}: {:.0f}° off {}", limb, mistake.amount, when);
        case MistakeKind::kLate:
            return fmt::format("{}: {:.2f} s {} {}", limb, std::abs(mistake.amount),
                               mistake.amount > 0 ? "late" : "early", when);
        case MistakeKind::kMirrored:
            return fmt::format("{}: turned to the other side, {:.0f}° off, {}", limb, mistake.amount, when);
    }
    return "";
}

SkeletonClip resampled(const SkeletonClip& clip, double fps) {
    if (clip.fps == fps) return clip;
    SkeletonClip result;
    result.fps = fps;
    const double duration_s = static_cast<double>(clip.frames.size() - 1) / clip.fps;
    if (!(duration_s * fps < static_cast<double>(kMaxSkeletonFrames)))
        throw InputError("compare", "",
                         fmt::format("a motion of {:.0f} s is too long for {:.6g} frames a second", duration_s, fps),
                         "cut it");
    const auto frames = static_cast<size_t>(std::floor(duration_s * fps + 1e-6)) + 1;
    for (size_t f = 0; f < frames; ++f) result.frames.push_back(pose_at(clip, static_cast<double>(f) / fps * clip.fps));
    return result;
}

Comparison compare(const SkeletonClip& trainer, const SkeletonClip& trainee, const CompareOptions& options) {
    return Comparer(trainer, trainee, options).run();
}

}  // namespace neuvv::motion
