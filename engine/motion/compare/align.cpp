#include "motion/compare/align.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace neuvv::motion {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kMostCells = 1 << 28;  // of a warp's table: a byte each
constexpr double kForget = 0.97;        // what costs of the past count for, frame by frame: half a second at 60 Hz
constexpr double kLagCost = 2e-4;       // a second² of lag: decides between frames that match alike

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

// A row of the table: the costs of matching a performed frame with the shown frames of its band, and how each came
// about.
struct WarpRow {
    size_t first = 0;
    std::vector<double> costs;
    std::vector<Step> steps;

    explicit WarpRow(Band band)
        : first(band.first), costs(band.last - band.first + 1, kFar), steps(band.last - band.first + 1) {}
    size_t last() const { return first + steps.size() - 1; }
    double cost(size_t j) const { return j >= first && j <= last() ? costs[j - first] : kFar; }
};

// Back from the end. A performed frame that several shown frames match gets the middle of them.
Warp path_of(const std::vector<WarpRow>& table) {
    const size_t rows = table.size();
    std::vector<double> first(rows, kFar), last(rows, 0);
    size_t i = rows - 1, j = table[i].last();
    Warp warp;
    warp.cost = table[i].costs.back();
    while (true) {
        first[i] = std::min(first[i], static_cast<double>(j));
        last[i] = std::max(last[i], static_cast<double>(j));
        if (i == 0 && j == table[0].first) break;
        const Step step = table[i].steps[j - table[i].first];
        if (step != Step::kShown && i > 0) --i;
        if (step != Step::kPerformed && j > 0) --j;
    }
    for (size_t row = 0; row < rows; ++row) warp.frames.push_back(0.5 * (first[row] + last[row]));
    return warp;
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

Warp warp(const Motion& shown, const Motion& performed, double band_s, bool without_trunk) {
    assert(!shown.frames.empty() && !performed.frames.empty() && shown.fps == performed.fps);
    const size_t rows = performed.frames.size(), columns = shown.frames.size();
    // Bands of neighbouring rows overlap.
    const double slope = static_cast<double>(columns) / static_cast<double>(rows);
    const double width = std::max({1.0, slope, band_s * shown.fps});
    if (static_cast<double>(rows) * std::min(2 * width + 2, static_cast<double>(columns)) > kMostCells)
        throw InputError(Setting{"band"}, "", fmt::format("{} s is too much for motions this long", band_s),
                         "choose a narrower band, or cut the motions");
    std::vector<WarpRow> table;
    for (size_t i = 0; i < rows; ++i) {
        WarpRow row(band_of(i, columns, rows, width));
        const WarpRow* before = table.empty() ? nullptr : &table.back();
        for (size_t j = row.first; j <= row.last(); ++j) {
            double best = before ? kFar : j == row.first ? 0 : kFar;
            Step step = Step::kBoth;
            const auto consider = [&](double cost, Step kind) {
                if (cost < best) best = cost, step = kind;
            };
            if (before && j > 0) consider(before->cost(j - 1), Step::kBoth);
            if (before) consider(before->cost(j) + kWarpStepCost, Step::kPerformed);
            if (j > row.first) consider(row.cost(j - 1) + kWarpStepCost, Step::kShown);
            row.costs[j - row.first] = best + distance(shown.frames[j], performed.frames[i], without_trunk);
            row.steps[j - row.first] = step;
        }
        if (before) table.back().costs.clear();
        table.push_back(std::move(row));
    }
    return path_of(table);
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
        double before = began_ ? costs_[j] + kWarpStepCost : 0;
        if (began_ && j > 0) before = std::min(before, costs_[j - 1]);
        if (began_ && j > 1) before = std::min(before, costs_[j - 2] + kWarpStepCost);
        const double lag = (static_cast<double>(j) - middle) / shown_.fps;
        now[j] = before + distance(shown_.frames[j], performed, true) + kLagCost * lag * lag;
        if (now[j] < now[best]) best = j;
    }
    // Costs are relative to the best, and old ones fade.
    if (now[best] == kFar) {  // the clip has jumped out of the band
        reset();
        return add(performed, clip_time_s);
    }
    for (size_t j = 0; j < now.size(); ++j) costs_[j] = kForget * (now[j] - now[best]);
    began_ = true;
    return static_cast<double>(best) / shown_.fps;
}

}  // namespace neuvv::motion
