// Chooses into how many blocks a still image is divided. The render thread draws one block at a time, so that it can
// turn to a new request after each of them. A block should take about the target time: smaller blocks would waste time,
// because each costs something beside its pixels.
#pragma once

#include <cstdint>

namespace neuvv::editor {

class BlockGrid {
  public:
    explicit BlockGrid(double target_ms) : target_ms_(target_ms) {}

    // Blocks along each side of the image.
    uint32_t side() const { return side_; }
    static constexpr uint32_t kMaxSide = 8;  // 64 in all, which bounds what blocks cost beside their pixels

    // Begins an image. The grid of the last image is kept, or made coarser where its blocks took much less than the
    // target. The image gets at least `min_side` blocks along each side.
    void begin(uint32_t min_side);
    // Notes that a block was drawn in this time. Returns true where the image must begin again with another grid:
    // because the block took too long, or because a finer grid turned out to be no faster. This happens at most a few
    // times an image.
    bool drawn(double milliseconds);

  private:
    double target_ms_;
    uint32_t side_ = 2;      // few at first: where blocks cost much beside their pixels, more would never become fewer
    double coarser_ms_ = 0;  // of the block of the coarser grid that this grid divides; 0: none
    double total_ms_ = 0;    // of the blocks drawn with this grid
    uint32_t blocks_ = 0;
    bool finer_is_useless_ = false;  // smaller blocks would hardly take less time
};

}  // namespace neuvv::editor
