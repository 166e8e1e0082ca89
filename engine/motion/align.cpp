#include "motion/align.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace neuvv::motion {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kStepCost = 0.004;  // of a step along one motion alone: 1 − cos 5°
constexpr double kForget = 0.97;     // what costs of the past count for, frame by frame: half a second at 60 Hz
constexpr double kLagCost = 2e-4;    // a second² of lag: decides between frames that match alike

enum class Step : uint8_t { kBoth, kPerformed, kShown };

// The shown frames with which a performed frame may be matched.
struct Band {
    size_t first = 0, last = 0;
};

Band band_of(size_t i, size_t shown, size_t performed, double width) {
    const double share = performed > 1 ? static_cast<double>(i) / static_cast<double>(performed - 1) : 0;
    const double middle = share * static_cast<double>(shown - 1);
    const double last = static_cast<double>(shown - 1);
    return {static_cast<size_t>(std::clamp(middle - width, 0.0, last)),
            static_cast<size_t>(std::clamp(std::ceil(middle + width), 0.0, last))};
}

}  // namespace

Motion motion_of(const SkeletonClip& clip) {
    Motion motion;
    motion.fps = clip.fps;
    for (const Pose& pose : clip.frames) motion.frames.push_back(directions_of(pose));
    return motion;
}

Directions directions_at(const Motion& motion, double frame) {
    const double at = std::clamp(frame, 0.0, static_cast<double>(motion.frames.size() - 1));
    const auto first = static_cast<size_t>(at);
    const double share = at - static_cast<double>(first);
    Directions result = motion.frames[first];
    if (share == 0) return result;
    const Directions& next = motion.frames[first + 1];
    for (size_t b = 0; b < kComparedBones; ++b) {
        const glm::dvec3 mean = glm::mix(result[b].direction, next[b].direction, share);
        if (glm::length(mean) > 1e-6) result[b].direction = glm::normalize(mean);
        result[b].weight = std::min(result[b].weight, next[b].weight);
    }
    return result;
}

std::vector<double> warp(const Motion& shown, const Motion& performed, double band_s, bool without_trunk) {
    assert(!shown.frames.empty() && !performed.frames.empty() && shown.fps == performed.fps);
    const size_t rows = performed.frames.size(), columns = shown.frames.size();
    const double width = std::max(1.0, band_s * shown.fps);
    std::vector<std::vector<Step>> steps(rows);
    std::vector<Band> bands(rows);
    std::vector<double> before(columns, kFar), now(columns, kFar);
    for (size_t i = 0; i < rows; ++i) {
        bands[i] = band_of(i, columns, rows, width);
        steps[i].resize(bands[i].last - bands[i].first + 1);
        std::ranges::fill(now, kFar);
        for (size_t j = bands[i].first; j <= bands[i].last; ++j) {
            double best = i == 0 && j == bands[0].first ? 0 : kFar;
            Step step = Step::kBoth;
            const auto consider = [&](double cost, Step kind) {
                if (cost < best) best = cost, step = kind;
            };
            if (i > 0 && j > 0) consider(before[j - 1], Step::kBoth);
            if (i > 0) consider(before[j] + kStepCost, Step::kPerformed);
            if (j > bands[i].first) consider(now[j - 1] + kStepCost, Step::kShown);
            now[j] = best + distance(shown.frames[j], performed.frames[i], without_trunk);
            steps[i][j - bands[i].first] = step;
        }
        std::swap(before, now);
    }
    // Back from the end. A performed frame that several shown frames match gets the middle of them.
    std::vector<double> first(rows, kFar), last(rows, 0), path(rows);
    size_t i = rows - 1, j = bands[i].last;
    while (true) {
        first[i] = std::min(first[i], static_cast<double>(j));
        last[i] = std::max(last[i], static_cast<double>(j));
        if (i == 0 && j == bands[0].first) break;
        const Step step = steps[i][j - bands[i].first];
        if (step != Step::kShown && i > 0) --i;
        if (step != Step::kPerformed && j > 0) --j;
    }
    for (size_t k = 0; k < rows; ++k) path[k] = 0.5 * (first[k] + last[k]);
    return path;
}

OnlineWarp::OnlineWarp(const Motion& shown, double band_s) : shown_(shown), band_s_(band_s) {
    reset();
}

void OnlineWarp::reset() {
    costs_.assign(shown_.frames.size(), 0);
    next_costs_ = costs_;
    began_ = false;
}

double OnlineWarp::add(const Directions& performed, double clip_time_s) {
    const double middle = clip_time_s * shown_.fps, width = std::max(1.0, band_s_ * shown_.fps);
    const double end = static_cast<double>(shown_.frames.size() - 1);
    const auto first = static_cast<size_t>(std::clamp(std::floor(middle - width), 0.0, end));
    const auto last = static_cast<size_t>(std::clamp(std::ceil(middle + width), 0.0, end));
    std::vector<double>& now = next_costs_;
    std::ranges::fill(now, kFar);
    size_t best = first;
    for (size_t j = first; j <= last; ++j) {
        double before = began_ ? costs_[j] + kStepCost : 0;
        if (began_ && j > 0) before = std::min(before, costs_[j - 1]);
        if (began_ && j > 1) before = std::min(before, costs_[j - 2] + kStepCost);
        const double lag = (static_cast<double>(j) - middle) / shown_.fps;
        now[j] = before + distance(shown_.frames[j], performed, true) + kLagCost * lag * lag;
        if (now[j] < now[best]) best = j;
    }
    // Costs are relative to the best, and old ones fade.
    for (size_t j = 0; j < now.size(); ++j) costs_[j] = kForget * (now[j] - now[best]);
    began_ = true;
    return static_cast<double>(best) / shown_.fps;
}

}  // namespace neuvv::motion
