#include "editor/draw/block_grid.h"

#include <algorithm>
#include <utility>

namespace neuvv::editor {

namespace {
constexpr double kTooLong = 1.5, kTooShort = 0.35;  // times the target
constexpr double kUselessShare = 0.6;               // of the time that a block with four times as many pixels took
}  // namespace

void BlockGrid::begin(uint32_t min_side) {
    if (blocks_ > 0 && total_ms_ < kTooShort * target_ms_ * blocks_) side_ = std::max(1u, side_ / 2);
    side_ = std::max(side_, min_side);
    coarser_ms_ = total_ms_ = 0;
    blocks_ = 0;
    finer_is_useless_ = false;
}

bool BlockGrid::drawn(double milliseconds) {
    const double coarser_ms = std::exchange(coarser_ms_, 0.0);
    if (coarser_ms > 0 && milliseconds > kUselessShare * coarser_ms) {
        finer_is_useless_ = true;
        side_ /= 2;
        return true;
    }
    total_ms_ += milliseconds;
    ++blocks_;
    if (finer_is_useless_ || milliseconds <= kTooLong * target_ms_ || 2 * side_ > kMaxSide) return false;
    coarser_ms_ = milliseconds;
    total_ms_ = 0;
    blocks_ = 0;
    side_ *= 2;
    return true;
}

}  // namespace neuvv::editor
