// Into how many blocks an image is cut that is drawn while the window goes on: each as small that nobody waits for it
// long, but not smaller than helps, as each costs something beside its pixels.
#pragma once

#include <cstdint>

namespace neuvv::editor {

class BlockGrid {
  public:
    explicit BlockGrid(double target_ms) : target_ms_(target_ms) {}

    // Blocks along each side.
    uint32_t side() const { return side_; }
    static constexpr uint32_t kMaxSide = 8;  // 64 in all: what each costs beside pixels stays within bounds

    // An image begins; kept from the last one: its grid, or a coarser one where its blocks took much less than the
    // target. At least `min_side` blocks a side.
    void begin(uint32_t min_side);
    // A block was drawn in this time. True: it took too long, or cutting it finer was in vain, and the image begins
    // again with another grid; at most a few times an image.
    bool drawn(double milliseconds);

  private:
    double target_ms_;
    uint32_t side_ = 4;
    double coarser_ms_ = 0;  // of a block twice as large, from which this grid was cut; 0: it was not
    double total_ms_ = 0;    // of the blocks drawn with this grid
    uint32_t blocks_ = 0;
    bool finer_is_useless_ = false;  // finer ones would hardly take less
};

}  // namespace neuvv::editor
