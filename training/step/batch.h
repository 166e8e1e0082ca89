// Which rays a training step traces, and what they should see (errata 10, 16, 17).
#pragma once

#include <random>

#include "shared/trace.h"
#include "training/data/dataset.h"
#include "training/tree/first_tree.h"

namespace neuvv::training {

// One step's tiles, all of one time.
struct Batch {
    double time = 0;     // [0,1]
    uint32_t frame = 0;  // its index in Dataset::times
    std::vector<Tile> tiles;
    // Per ray: premultiplied linear RGB and alpha of the foreground. Alpha is −1 beyond the image and where the pixel
    // is ignored.
    std::vector<glm::vec4> target;
    std::vector<glm::vec4> background;  // per ray: linear RGB
    uint32_t samples = 1;  // rays along each side of a pixel: tiles count in images enlarged by this factor
};

constexpr uint32_t kEveryTile = UINT32_MAX;  // a reach of all tiles

// Draws batches. Times come in random order, `in_a_row` batches of each (fewer where that would be more than an eighth
// of a time's epoch), until every time had its turn; then they come in a new order. Of a time's images, every tile with
// foreground is drawn once per epoch, and a fifth of the tiles near them. All rays of a tile leave from the same random
// position inside their pixels, because a pixel is a mean over its area, which its centre does not represent. The
// background of the rays is the camera's clean plate where there is one, else one random colour per tile. The same seed
// and data give the same batches.
class BatchSampler {
  public:
    // The data set must outlive it. `reach`: how many tiles away from one with foreground those without it may lie that
    // are drawn (reach_of_hull() says how many).
    BatchSampler(const Dataset& dataset, uint32_t tiles_per_batch, uint64_t seed, uint32_t in_a_row = 1,
                 uint32_t reach = kLeastReach);

    // A batch has at least one image tile, and no more than fit into tiles_per_batch tiles: an image tile becomes
    // samples² tiles of rays. `samples` must divide kTile. Of the batch's image tiles, the share `part` of `parts`
    // shares of about equal size is returned, whose rays are those that the whole batch has there; it may be empty.
    Batch next(uint32_t samples = 1, uint32_t part = 0, uint32_t parts = 1);

    // Draws a batch without building it. A resumed run skips the batches that it has trained on before.
    void skip(uint32_t samples = 1) { draw(samples); }

    // A batch of up to so many tiles with foreground of each image of a time, one image after the other, drawn apart
    // from those of next(). The same seed gives the same tiles.
    Batch sample(size_t frame, uint32_t tiles_per_view, uint64_t seed) const;

    // Pixels of one epoch, all times together.
    uint64_t rays_per_epoch() const { return rays_per_epoch_; }

  private:
    struct ViewTile {
        uint32_t view;
        uint16_t x, y;  // in tiles
    };
    struct FrameViews {
        std::vector<uint32_t> views;
        std::vector<ViewTile> queue;  // tiles of this epoch that are still to come, drawn from the back
    };
    void refill(FrameViews& frame);
    struct Drawn {
        uint32_t frame;
        std::vector<ViewTile> tiles;
    };
    Drawn draw(uint32_t samples);
    void fill(Batch& batch, size_t number, const ViewTile& tile, std::mt19937_64& random) const;
    void fill_rays(Batch& batch, size_t index, const View& view, glm::vec4 colour) const;
    template <typename T>
    void shuffle(std::vector<T>& values);

    const Dataset& dataset_;
    uint32_t tiles_per_batch_;
    uint64_t seed_, batches_drawn_ = 0;
    uint32_t in_a_row_, reach_;
    std::mt19937_64 random_;
    std::vector<FrameViews> frames_;
    std::vector<uint32_t> times_left_;  // frames whose turn is still to come; the last one is drawn from
    uint32_t left_of_time_ = 0;         // batches still to come of that frame
    uint64_t rays_per_epoch_ = 0;
};

}  // namespace neuvv::training
