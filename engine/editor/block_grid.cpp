#include "editor/block_grid.h"

#include <algorithm>
#include <utility>

namespace neuvv::editor {

namespace {
constexpr double kTooLong = 1.5, kShort = 0.35;  // of the target
constexpr double kHardlyLess = 0.6;              // of the time of four times as many pixels
}  // namespace

void BlockGrid::begin(uint32_t least) {
    if (blocks_ > 0 && all_ms_ < kShort * target_ms_ * blocks_) side_ = std::max(1u, side_ / 2);
    side_ = std::max(side_, least);
    coarser_ms_ = all_ms_ = 0;
    blocks_ = 0;
    in_vain_ = false;
}

bool BlockGrid::drawn(double milliseconds) {
    const double coarser_ms = std::exchange(coarser_ms_, 0.0);
    if (coarser_ms > 0 && milliseconds > kHardlyLess * coarser_ms) {
        in_vain_ = true;
        side_ /= 2;
        return true;
    }
    all_ms_ += milliseconds;
    blocks_++;
    if (in_vain_ || milliseconds <= kTooLong * target_ms_ || 2 * side_ > kMostBlocks) return false;
    coarser_ms_ = milliseconds;
    all_ms_ = 0;
    blocks_ = 0;
    side_ *= 2;
    return true;
}

}  // namespace neuvv::editor
