#include "editor/draw/dynamic_scale.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::editor {

namespace {

// The weight of older images shrinks by this factor at each image: as good as a mean of nine images.
constexpr double kDecay = 0.8;
constexpr double kOutlier = 1.6;  // beyond what is possible by this factor: another view, so the past is dropped
// The standard deviation of scale², as a share of its mean, from which on the slope is measured rather than assumed.
constexpr double kTrustedSpread = 0.2;
// The smallest share of an image's time that may depend on its size. A smaller share would let noise move the scale
// far.
constexpr double kMinTracedShare = 0.2;

}  // namespace

DynamicScale::DynamicScale(double target_ms, double scale) : target_ms_(target_ms), scale_(scale) {
    assert(target_ms > 0 && scale >= kMinScale && scale <= 1);
}

void DynamicScale::drawn(double scale, double milliseconds) {
    if (!(scale > 0 && milliseconds > 0 && std::isfinite(scale * milliseconds))) return;
    const double x = scale * scale;
    // The same view can take no more and no less than it would if its costs were all fixed or all proportional to its
    // size.
    const double all_fixed = y_ / count_, all_size = x * y_ / x_;
    const bool outlier = count_ == 0 || milliseconds > kOutlier * std::max(all_fixed, all_size) ||
                         milliseconds * kOutlier < std::min(all_fixed, all_size);
    const double kept = outlier ? 0 : kDecay;
    count_ = kept * count_ + 1;
    x_ = kept * x_ + x;
    y_ = kept * y_ + milliseconds;
    xx_ = kept * xx_ + x * x;
    xy_ = kept * xy_ + x * milliseconds;
    fit();

    const double next = target_scale();
    if (next < scale_ * (1 - kMinChange) || (next == kMinScale && scale_ > next))
        scale_ = next;
    else if (next > scale_ * (1 + kMinChange) || (next == 1 && scale_ < 1))
        scale_ = std::min(next, scale_ * kMaxGrowth);
}

// Least squares, pulled towards costs that are all proportional to the size where the drawn sizes are too similar to
// measure the slope.
void DynamicScale::fit() {
    const double x = x_ / count_, y = y_ / count_;
    const double spread = std::max(xx_ / count_ - x * x, 0.0), along = xy_ / count_ - x * y;
    const double assumed = y / x, prior = kTrustedSpread * kTrustedSpread * x * x;
    full_ms_ = std::clamp((along + prior * assumed) / (spread + prior), kMinTracedShare * assumed, assumed);
    fixed_ms_ = y - full_ms_ * x;
}

double DynamicScale::target_scale() const {
    const double left = std::max(target_ms_ - fixed_ms_, 0.0);
    return std::clamp(std::sqrt(left / full_ms_), kMinScale, 1.0);
}

}  // namespace neuvv::editor
