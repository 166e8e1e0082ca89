#include "editor/dynamic_scale.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::editor {

namespace {

constexpr double kDecay = 0.8;    // how much the past counts at each image: nine images' worth of averaging
constexpr double kOutlier = 1.6;  // times as slow or fast as can be: another view, the past says nothing
// Spread of scale² about its mean, as a share of it, from which the slope is measured rather than assumed.
constexpr double kTrustedSpread = 0.2;
// Of the time of an image: what depends on its size. Less would let noise move the scale far.
constexpr double kMinShare = 0.2;

}  // namespace

DynamicScale::DynamicScale(double target_ms, double scale) : target_ms_(target_ms), scale_(scale) {
    assert(target_ms > 0 && scale >= kMinScale && scale <= 1);
}

void DynamicScale::drawn(double scale, double milliseconds) {
    if (!(scale > 0 && milliseconds > 0 && std::isfinite(scale * milliseconds))) return;
    const double x = scale * scale;
    // Costs that are all fixed or all in the size bound what the same view can take.
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

// Least squares, drawn towards costs that are all in the size where the sizes drawn are too alike to notify.
void DynamicScale::fit() {
    const double x = x_ / count_, y = y_ / count_;
    const double spread = std::max(xx_ / count_ - x * x, 0.0), along = xy_ / count_ - x * y;
    const double assumed = y / x, prior = kTrustedSpread * kTrustedSpread * x * x;
    full_ms_ = std::clamp((along + prior * assumed) / (spread + prior), kMinShare * assumed, assumed);
    fixed_ms_ = y - full_ms_ * x;
}

double DynamicScale::target_scale() const {
    const double left = std::max(target_ms_ - fixed_ms_, 0.0);
    return std::clamp(std::sqrt(left / full_ms_), kMinScale, 1.0);
}

}  // namespace neuvv::editor
