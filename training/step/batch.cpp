#include "training/step/batch.h"

#include <algorithm>
#include <glm/gtc/packing.hpp>
#include <numeric>

#include "base/threads/parallel.h"
#include "base/trace_file.h"

namespace neuvv::training {

namespace {

constexpr float kBackgroundShare = 0.2f;
constexpr size_t kTilesOfThread = 128;     // image tiles that one thread fills in: about 0.2 ms of work
constexpr double kMaxShareInARow = 0.125;  // of a time's epoch; larger shares make the field forget other times

glm::vec4 linear_rgb(const uint8_t* srgb) {
    return {media::linear_from_srgb_byte(srgb[0]), media::linear_from_srgb_byte(srgb[1]),
            media::linear_from_srgb_byte(srgb[2]), 0};
}

float uniform(std::mt19937_64& random) {
    return static_cast<float>(random() >> 40) * 0x1p-24f;
}

// By rows of tiles: whether a tile lies at most `reach` tiles away from one with foreground.
std::vector<bool> tiles_near_foreground(const TiledImage& image, uint32_t reach) {
    const uint32_t across = image.tiles_across(), down = image.tiles_down();
    if (reach == kEveryTile) return std::vector<bool>(size_t{across} * down, true);
    std::vector<bool> near(size_t{across} * down);
    for (uint32_t y = 0; y < down; ++y)
        for (uint32_t x = 0; x < across; ++x) {
            if (!image.has_tile(x, y)) continue;
            const uint32_t first_x = x - std::min(x, reach), first_y = y - std::min(y, reach);
            for (uint32_t v = first_y; v < std::min(y + reach + 1, down); ++v)
                for (uint32_t u = first_x; u < std::min(x + reach + 1, across); ++u)
                    near[size_t{v} * across + u] = true;
        }
    return near;
}

// How many random numbers fill() draws for an image tile: its background, and where the rays of each tile of rays lie
// in their pixels.
uint64_t numbers_of_tile(uint32_t samples) {
    return 1 + uint64_t{2} * samples * samples;
}

// Room for so many more image tiles.
void make_room(Batch& batch, size_t image_tiles) {
    const size_t tiles = batch.tiles.size() + image_tiles * batch.samples * batch.samples;
    batch.tiles.resize(tiles);
    batch.target.resize(tiles * kTilePixels);
    batch.background.resize(tiles * kTilePixels);
}

static_assert(TiledImage::kSide == kTile, "the tiles of a batch are those of the images");

}  // namespace

BatchSampler::BatchSampler(const Dataset& dataset, uint32_t tiles_per_batch, uint64_t seed, uint32_t in_a_row,
                           uint32_t reach)
    : dataset_(dataset), tiles_per_batch_(tiles_per_batch), seed_(seed), in_a_row_(1), reach_(reach), random_(seed) {
    frames_.resize(dataset.times.size());
    double tiles = 0;
    for (uint32_t i = 0; i < dataset.views.size(); ++i) {
        const auto time = std::lower_bound(dataset.times.begin(), dataset.times.end(), dataset.views[i].time);
        frames_[static_cast<size_t>(time - dataset.times.begin())].views.push_back(i);
        const TiledImage& image = dataset.views[i].image;
        const auto foreground = static_cast<double>(image.tile_count());
        const std::vector<bool> near = tiles_near_foreground(image, reach_);
        const auto drawn_from = static_cast<double>(std::count(near.begin(), near.end(), true));
        tiles += foreground + double{kBackgroundShare} * (drawn_from - foreground);
    }
    rays_per_epoch_ = static_cast<uint64_t>(tiles * kTilePixels);
    const double batches = tiles / static_cast<double>(frames_.size()) / std::max(tiles_per_batch, 1u);
    in_a_row_ =
        static_cast<uint32_t>(std::clamp(kMaxShareInARow * batches, 1.0, static_cast<double>(std::max(in_a_row, 1u))));
}

template <typename T>
void BatchSampler::shuffle(std::vector<T>& values) {
    for (size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random_() % i]);
}

void BatchSampler::refill(FrameViews& frame) {
    for (const uint32_t view : frame.views) {
        const TiledImage& image = dataset_.views[view].image;
        const std::vector<bool> near = tiles_near_foreground(image, reach_);
        for (uint32_t y = 0; y < image.tiles_down(); ++y)
            for (uint32_t x = 0; x < image.tiles_across(); ++x)
                if (near[size_t{y} * image.tiles_across() + x] &&
                    (image.has_tile(x, y) || uniform(random_) < kBackgroundShare))
                    frame.queue.push_back({view, static_cast<uint16_t>(x), static_cast<uint16_t>(y)});
    }
    if (frame.queue.empty()) frame.queue.push_back({frame.views[0], 0, 0});
    shuffle(frame.queue);
}

BatchSampler::Drawn BatchSampler::draw(uint32_t samples) {
    if (left_of_time_ == 0 && !times_left_.empty()) times_left_.pop_back();
    if (times_left_.empty()) {
        times_left_.resize(frames_.size());
        std::iota(times_left_.begin(), times_left_.end(), 0u);
        shuffle(times_left_);
    }
    if (left_of_time_ == 0) left_of_time_ = in_a_row_;
    --left_of_time_;
    Drawn drawn{times_left_.back(), {}};
    FrameViews& frame = frames_[drawn.frame];
    if (frame.queue.empty()) refill(frame);
    const size_t count = std::max<size_t>(tiles_per_batch_ / (samples * samples), 1);
    const auto first = frame.queue.end() - static_cast<ptrdiff_t>(std::min(count, frame.queue.size()));
    drawn.tiles.assign(first, frame.queue.end());
    frame.queue.erase(first, frame.queue.end());
    if (frame.queue.empty()) left_of_time_ = 0;
    ++batches_drawn_;
    return drawn;
}

Batch BatchSampler::next(uint32_t samples, uint32_t part, uint32_t parts) {
    const TraceSpan span("draw a batch");
    const Drawn drawn = draw(samples);
    Batch batch;
    batch.samples = samples;
    batch.time = dataset_.times[drawn.frame];
    batch.frame = drawn.frame;
    const size_t first = drawn.tiles.size() * part / parts, end = drawn.tiles.size() * (part + 1) / parts;
    make_room(batch, end - first);
    parallel_for(end - first, kTilesOfThread, [&](size_t from, size_t to) {
        // A generator for this batch alone, so that skip() need not draw its numbers.
        std::mt19937_64 random(seed_ ^ batches_drawn_ * 0x9e3779b97f4a7c15u);
        random.discard((first + from) * numbers_of_tile(samples));
        for (size_t i = from; i < to; ++i) fill(batch, i, drawn.tiles[first + i], random);
    });
    return batch;
}

Batch BatchSampler::sample(size_t frame, uint32_t tiles_per_view, uint64_t seed) const {
    Batch batch;
    batch.time = dataset_.times[frame];
    batch.frame = static_cast<uint32_t>(frame);
    std::mt19937_64 random(seed);
    for (const uint32_t view : frames_[frame].views) {
        const TiledImage& image = dataset_.views[view].image;
        std::vector<ViewTile> tiles;
        for (uint32_t y = 0; y < image.tiles_down(); ++y)
            for (uint32_t x = 0; x < image.tiles_across(); ++x)
                if (image.has_tile(x, y)) tiles.push_back({view, static_cast<uint16_t>(x), static_cast<uint16_t>(y)});
        for (uint32_t i = 0; i < tiles_per_view && i < tiles.size(); ++i) {
            std::swap(tiles[i], tiles[i + random() % (tiles.size() - i)]);
            make_room(batch, 1);
            fill(batch, batch.tiles.size() - 1, tiles[i], random);
        }
    }
    return batch;
}

// Fills in the image tile `number` of the batch, whose rays are `samples` by `samples` of its tiles.
void BatchSampler::fill(Batch& batch, size_t number, const ViewTile& tile, std::mt19937_64& random) const {
    const uint64_t bits = random();
    const uint8_t random_rgb[3] = {static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8),
                                   static_cast<uint8_t>(bits >> 16)};
    const glm::vec4 colour = linear_rgb(random_rgb);
    for (uint32_t y = 0; y < batch.samples; ++y)
        for (uint32_t x = 0; x < batch.samples; ++x) {
            const float right = uniform(random) - 0.5f, down = uniform(random) - 0.5f;
            const size_t index = number * batch.samples * batch.samples + size_t{y} * batch.samples + x;
            batch.tiles[index] = {dataset_.views[tile.view].camera, (tile.x * batch.samples + x) * kTile,
                                  (tile.y * batch.samples + y) * kTile, glm::packSnorm2x16(glm::vec2(right, down))};
            fill_rays(batch, index, dataset_.views[tile.view], colour);
        }
}

// Fills in what the rays of a tile of the batch should see.
void BatchSampler::fill_rays(Batch& batch, size_t index, const View& view, glm::vec4 colour) const {
    const media::Image& plate = dataset_.plates[view.camera];
    const Tile& tile = batch.tiles[index];
    for (uint32_t i = 0; i < kTilePixels; ++i) {
        const uint32_t x = (tile.x + i % kTile) / batch.samples, y = (tile.y + i / kTile) / batch.samples;
        glm::vec4 target(0, 0, 0, -1), background = colour;
        if (x < view.image.width() && y < view.image.height() && !view.ignores(x, y)) {
            target = foreground(dataset_, view, x, y);
            if (plate.width > 0) background = linear_rgb(plate.at(x, y));
        }
        batch.target[index * kTilePixels + i] = target;
        batch.background[index * kTilePixels + i] = background;
    }
}

}  // namespace neuvv::training
