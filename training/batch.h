// Which rays a step traces, and what they should see (errata 10, 16, 17).
#pragma once

#include <random>

#include "shared/trace.h"
#include "training/dataset.h"

namespace neuvv::training {

// One step's tiles, all of one time.
struct Batch {
    double time = 0;  // [0,1]
    std::vector<Tile> tiles;
    std::vector<glm::vec4>
        target;  // per ray premultiplied linear foreground and alpha; alpha −1 off the image or ignored
    std::vector<glm::vec4> background;  // per ray linear RGB
    uint32_t samples = 1;               // rays a pixel, per side: tiles are of images enlarged so much
};

// Draws batches: times in random rounds, `in_a_row` batches each (fewer where that would be
// more than an eighth of a time's epoch); of a time's
// images every tile with foreground once an epoch, and a fifth of the tiles without. A tile's rays all leave from one
// random place inside their pixels: a pixel is a mean over its area, and what the field shows at its centre must not
// stand for the rest. Behind the rays stands the captured plate where there is one, else one random colour a tile. The
// same seed and data give the same batches.
class BatchSampler {
  public:
    // The data set must outlive it.
    BatchSampler(const Dataset& dataset, uint32_t tiles_per_batch, uint64_t seed, uint32_t in_a_row = 1);

    // At most tiles_per_batch tiles (or one image tile's samples²), never none. `samples` divides kTile.
    Batch next(uint32_t samples = 1);

    // Draws a batch and forgets it, as a resumed run does for each one that it has trained on.
    void skip(uint32_t samples = 1) { draw(samples); }

    // Pixels of one epoch over every time.
    uint64_t rays_per_epoch() const { return rays_per_epoch_; }

  private:
    struct ViewTile {
        uint32_t view;
        uint16_t x, y;  // in tiles
    };
    struct FrameViews {
        std::vector<uint32_t> views;
        std::vector<ViewTile> queue;  // of this epoch, drawn from the back
    };
    void refill(FrameViews& frame);
    struct Drawn {
        uint32_t frame;
        std::vector<ViewTile> tiles;
    };
    Drawn draw(uint32_t samples);
    void append(Batch& batch, const ViewTile& tile, std::mt19937_64& random) const;
    void append_rays(Batch& batch, const View& view, glm::vec4 colour) const;
    template <typename T>
    void shuffle(std::vector<T>& values);

    const Dataset& dataset_;
    uint32_t tiles_per_batch_;
    uint64_t seed_, batches_drawn_ = 0;
    uint32_t in_a_row_;
    std::mt19937_64 random_;
    std::vector<FrameViews> frames_;
    std::vector<uint32_t> times_left_;               // times left of this round, the last one drawn from
    uint32_t left_of_time_ = 0;                      // batches that it still gives
    std::vector<std::vector<bool>> has_foreground_;  // per view, per tile
    uint64_t rays_per_epoch_ = 0;
};

}  // namespace neuvv::training
