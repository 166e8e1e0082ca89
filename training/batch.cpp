#include "training/batch.h"

#include <algorithm>
#include <glm/gtc/packing.hpp>
#include <numeric>

#include "base/parallel.h"

namespace neuvv {

namespace {

constexpr double kBackgroundShare = 0.2;

uint32_t tiles_across(uint32_t pixels) {
    return (pixels + kTile - 1) / kTile;
}

glm::vec4 linear_rgb(const uint8_t* srgb) {
    return {linear_from_srgb_byte(srgb[0]), linear_from_srgb_byte(srgb[1]), linear_from_srgb_byte(srgb[2]), 0};
}

std::vector<bool> find_foreground(const Image& image) {
    const uint32_t across = tiles_across(image.width);
    std::vector<bool> found(size_t{across} * tiles_across(image.height));
    for (uint32_t y = 0; y < image.height; y++)
        for (uint32_t x = 0; x < image.width; x++)
            if (image.at(x, y)[3] > 0) found[size_t{y / kTile} * across + x / kTile] = true;
    return found;
}

}  // namespace

BatchSampler::BatchSampler(const Dataset& dataset, uint32_t tiles_per_batch, uint64_t seed)
    : dataset_(dataset), tiles_per_batch_(tiles_per_batch), random_(seed), has_foreground_(dataset.views.size()) {
    parallel_for(dataset.views.size(), 8, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) has_foreground_[i] = find_foreground(dataset.views[i].image);
    });
    instants_.resize(dataset.times.size());
    double tiles = 0;
    for (uint32_t i = 0; i < dataset.views.size(); i++) {
        const auto time = std::lower_bound(dataset.times.begin(), dataset.times.end(), dataset.views[i].time);
        instants_[static_cast<size_t>(time - dataset.times.begin())].views.push_back(i);
        const auto foreground = std::count(has_foreground_[i].begin(), has_foreground_[i].end(), true);
        tiles += static_cast<double>(foreground) +
                 kBackgroundShare * (static_cast<double>(has_foreground_[i].size()) - static_cast<double>(foreground));
    }
    rays_per_epoch_ = static_cast<uint64_t>(tiles * kTilePixels);
}

template <typename T>
void BatchSampler::shuffle(std::vector<T>& values) {
    for (size_t i = values.size(); i > 1; i--) std::swap(values[i - 1], values[random_() % i]);
}

void BatchSampler::refill(Instant& instant) {
    for (const uint32_t view : instant.views) {
        const uint32_t across = tiles_across(dataset_.views[view].image.width);
        const std::vector<bool>& foreground = has_foreground_[view];
        for (size_t i = 0; i < foreground.size(); i++)
            if (foreground[i] || uniform() < kBackgroundShare)
                instant.queue.push_back({view, static_cast<uint16_t>(i % across), static_cast<uint16_t>(i / across)});
    }
    if (instant.queue.empty()) instant.queue.push_back({instant.views[0], 0, 0});
    shuffle(instant.queue);
}

Batch BatchSampler::next() {
    if (round_.empty()) {
        round_.resize(instants_.size());
        std::iota(round_.begin(), round_.end(), 0u);
        shuffle(round_);
    }
    const uint32_t chosen = round_.back();
    round_.pop_back();
    Instant& instant = instants_[chosen];
    Batch batch;
    batch.time = dataset_.times[chosen];
    if (instant.queue.empty()) refill(instant);
    while (batch.tiles.size() < tiles_per_batch_ && !instant.queue.empty()) {
        append(batch, instant.queue.back());
        instant.queue.pop_back();
    }
    return batch;
}

void BatchSampler::append(Batch& batch, const ViewTile& tile) {
    const View& view = dataset_.views[tile.view];
    const Image& plate = dataset_.plates[view.camera];
    const uint64_t draw = random_();
    const uint8_t random_rgb[3] = {static_cast<uint8_t>(draw), static_cast<uint8_t>(draw >> 8),
                                   static_cast<uint8_t>(draw >> 16)};
    const glm::vec4 colour = linear_rgb(random_rgb);
    const double right = uniform() - 0.5, down = uniform() - 0.5;
    batch.tiles.push_back({view.camera, tile.x * kTile, tile.y * kTile, glm::packSnorm2x16(glm::vec2(right, down))});
    for (uint32_t i = 0; i < kTilePixels; i++) {
        const uint32_t x = tile.x * kTile + i % kTile, y = tile.y * kTile + i / kTile;
        glm::vec4 target(0, 0, 0, -1), background = colour;
        if (x < view.image.width && y < view.image.height && !view.ignores(x, y)) {
            target = foreground(dataset_, view, x, y);
            if (plate.width > 0) background = linear_rgb(plate.at(x, y));
        }
        batch.target.push_back(target);
        batch.background.push_back(background);
    }
}

}  // namespace neuvv
