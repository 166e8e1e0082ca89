// Which tiles a batch holds, and what they should see.
#include "training/step/batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/packing.hpp>

#include <map>

#include "support/edit_image.h"
#include "support/sphere_capture.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kSize = 44;                                     // pixels: six tiles, the last of which is cut
using TileKey = std::tuple<double, uint32_t, uint32_t, uint32_t>;  // time, camera, x, y

const training::Dataset& batch_capture() {
    static const training::Dataset dataset =
        sphere_dataset({.cameras = 10, .frames = 2, .size = kSize, .travel_m = 0.2});
    return dataset;
}

TileKey key_of(const training::Batch& batch, const Tile& tile) {
    return {batch.time, tile.camera, tile.x, tile.y};
}

const training::View& view_of(const training::Dataset& dataset, double time, uint32_t camera) {
    for (const training::View& view : dataset.views)
        if (view.time == time && view.camera == camera) return view;
    throw std::logic_error("no such view");
}

bool holds_foreground(const training::View& view, uint32_t x0, uint32_t y0) {
    for (uint32_t y = y0; y < std::min(y0 + kTile, view.image.height()); ++y)
        for (uint32_t x = x0; x < std::min(x0 + kTile, view.image.width()); ++x)
            if (view.image.at(x, y)[3] > 0) return true;
    return false;
}

// Whether a tile at most two tiles away holds foreground.
bool is_near_foreground(const training::View& view, uint32_t x0, uint32_t y0) {
    constexpr uint32_t kReach = 2 * kTile;
    for (uint32_t y = y0 - std::min(y0, kReach); y <= y0 + kReach; y += kTile)
        for (uint32_t x = x0 - std::min(x0, kReach); x <= x0 + kReach; x += kTile)
            if (holds_foreground(view, x, y)) return true;
    return false;
}

// How often each tile is drawn until each time has ended one epoch.
std::map<TileKey, uint32_t> draws_of_an_epoch(training::BatchSampler& sampler, size_t times) {
    std::map<TileKey, uint32_t> draws;
    for (size_t i = 0; i < times; ++i) {
        const training::Batch batch = sampler.next();
        for (const Tile& tile : batch.tiles) ++draws[key_of(batch, tile)];
    }
    return draws;
}

TEST(Batch, PartsTogetherAreTheWholeBatch) {
    // The larger batches are filled in by several threads, whose shares begin elsewhere than the parts.
    for (const auto& [samples, batch] : {std::pair{1u, 60u}, {2u, 60u}, {1u, 1000u}, {2u, 4000u}}) {
        const training::Batch whole = training::BatchSampler(batch_capture(), batch, 3).next(samples);
        if (batch >= 1000) {
            EXPECT_GT(whole.tiles.size(), size_t{128} * samples * samples);
        }
        std::vector<Tile> tiles;
        std::vector<glm::vec4> background;
        for (uint32_t part = 0; part < 4; ++part) {
            const training::Batch share = training::BatchSampler(batch_capture(), batch, 3).next(samples, part, 4);
            EXPECT_EQ(share.time, whole.time);
            tiles.insert(tiles.end(), share.tiles.begin(), share.tiles.end());
            background.insert(background.end(), share.background.begin(), share.background.end());
        }
        ASSERT_EQ(tiles.size(), whole.tiles.size());
        for (size_t i = 0; i < tiles.size(); ++i) {
            EXPECT_EQ(key_of(whole, tiles[i]), key_of(whole, whole.tiles[i]));
            EXPECT_EQ(tiles[i].jitter, whole.tiles[i].jitter) << "rays leave from other places in their pixels";
        }
        EXPECT_EQ(background, whole.background);
    }
}

TEST(Batch, EveryForegroundTileOnceAnEpochAndAFifthOfThoseNearThem) {
    const uint32_t size = 84;
    const training::Dataset dataset = sphere_dataset({.cameras = 10, .frames = 2, .size = size, .travel_m = 0.2});
    training::BatchSampler sampler(dataset, 100000, 3);
    size_t near = 0, near_drawn = 0, far = 0, rays = 0;
    for (int epoch = 0; epoch < 5; ++epoch) {
        const std::map<TileKey, uint32_t> draws = draws_of_an_epoch(sampler, dataset.times.size());
        for (const training::View& view : dataset.views)
            for (uint32_t y = 0; y < size; y += kTile)
                for (uint32_t x = 0; x < size; x += kTile) {
                    const auto found = draws.find({view.time, view.camera, x, y});
                    const uint32_t count = found == draws.end() ? 0 : found->second;
                    rays += count * kTilePixels;
                    if (holds_foreground(view, x, y)) {
                        EXPECT_EQ(count, 1u) << view.name << ' ' << x << ' ' << y;
                    } else if (is_near_foreground(view, x, y)) {
                        EXPECT_LE(count, 1u);
                        ++near;
                        near_drawn += count;
                    } else {
                        EXPECT_EQ(count, 0u) << view.name << ' ' << x << ' ' << y;
                        ++far;
                    }
                }
    }
    ASSERT_GT(near, 1000u);
    ASSERT_GT(far, 1000u);
    EXPECT_NEAR(static_cast<double>(near_drawn) / static_cast<double>(near), 0.2, 0.04);
    const double expected = 5.0 * static_cast<double>(sampler.rays_per_epoch());
    EXPECT_NEAR(static_cast<double>(rays), expected, 0.1 * expected);
}

TEST(Batch, InstantsComeInRunsAndEvenly) {
    constexpr uint32_t kInARow = 3;
    training::BatchSampler sampler(batch_capture(), 2, 8, kInARow);
    std::map<double, int> batches;
    std::vector<double> times;
    for (uint32_t i = 0; i < 8 * kInARow; ++i) {
        times.push_back(sampler.next().time);
        ++batches[times.back()];
    }
    for (uint32_t i = 1; i < times.size(); ++i) EXPECT_TRUE(i % kInARow == 0 || times[i] == times[i - 1]) << i;
    ASSERT_EQ(batches.size(), 2u);
    for (const auto& [time, count] : batches) EXPECT_EQ(count, 4 * static_cast<int>(kInARow)) << time;
}

TEST(Batch, SmallBatchesSeeEveryForegroundTileBeforeAnyTwice) {
    training::BatchSampler sampler(batch_capture(), 7, 4);
    std::map<TileKey, uint32_t> draws;
    std::map<double, bool> ended;
    while (ended.size() < batch_capture().times.size()) {
        const training::Batch batch = sampler.next();
        ASSERT_GT(batch.tiles.size(), 0u);
        ASSERT_LE(batch.tiles.size(), 7u);
        for (const Tile& tile : batch.tiles) {
            if (ended.contains(batch.time)) continue;
            if (++draws[key_of(batch, tile)] == 2) ended[batch.time] = true;
        }
    }
    for (const training::View& view : batch_capture().views)
        for (uint32_t y = 0; y < kSize; y += kTile)
            for (uint32_t x = 0; x < kSize; x += kTile)
                if (holds_foreground(view, x, y)) {
                    EXPECT_GE((draws[{view.time, view.camera, x, y}]), 1u) << view.name << ' ' << x << ' ' << y;
                }
}

TEST(Batch, TheSameSeedGivesTheSameBatches) {
    training::BatchSampler a(batch_capture(), 50, 5), b(batch_capture(), 50, 5), other(batch_capture(), 50, 6);
    bool differs = false;
    for (int i = 0; i < 20; ++i) {
        const training::Batch from_a = a.next(), from_b = b.next(), from_other = other.next();
        EXPECT_EQ(from_a.time, from_b.time);
        EXPECT_EQ(from_a.target, from_b.target);
        ASSERT_EQ(from_a.tiles.size(), from_b.tiles.size());
        for (size_t k = 0; k < from_a.tiles.size(); ++k) EXPECT_EQ(from_a.tiles[k].jitter, from_b.tiles[k].jitter);
        EXPECT_EQ(from_a.background, from_b.background);
        differs |= from_a.target != from_other.target;
    }
    EXPECT_TRUE(differs);
}

TEST(Batch, ASkippedBatchChangesNothingThatFollows) {
    training::BatchSampler whole(batch_capture(), 9, 5), resumed(batch_capture(), 9, 5);
    for (int i = 0; i < 12; ++i) {
        const uint32_t samples = i < 7 ? 1 : 2;
        whole.next(samples);
        resumed.skip(samples);
    }
    for (int i = 0; i < 8; ++i) {
        const training::Batch a = whole.next(2), b = resumed.next(2);
        EXPECT_EQ(a.time, b.time);
        EXPECT_EQ(a.target, b.target);
        EXPECT_EQ(a.background, b.background);
        ASSERT_EQ(a.tiles.size(), b.tiles.size());
        for (size_t k = 0; k < a.tiles.size(); ++k) EXPECT_EQ(a.tiles[k].jitter, b.tiles[k].jitter);
    }
}

TEST(Batch, SeveralRaysSeeOnePixel) {
    training::BatchSampler sampler(batch_capture(), 400, 6);
    const training::Batch batch = sampler.next(2);
    ASSERT_EQ(batch.tiles.size() % 4, 0u);
    EXPECT_LE(batch.tiles.size(), 400u);
    std::map<std::tuple<uint32_t, uint32_t, uint32_t>, glm::vec4> pixels;
    for (size_t i = 0; i < batch.target.size(); ++i) {
        const Tile& tile = batch.tiles[i / kTilePixels];
        const auto x = static_cast<uint32_t>(tile.x + i % kTile) / 2,
                   y = static_cast<uint32_t>(tile.y + i % kTilePixels / kTile) / 2;
        const auto [found, fresh] = pixels.try_emplace({tile.camera, x, y}, batch.target[i]);
        EXPECT_EQ(found->second, batch.target[i]);
        const auto view =
            std::find_if(batch_capture().views.begin(), batch_capture().views.end(),
                         [&](const training::View& v) { return v.camera == tile.camera && v.time == batch.time; });
        ASSERT_NE(view, batch_capture().views.end());
        if (x < kSize && y < kSize) {
            EXPECT_EQ(batch.target[i], training::foreground(batch_capture(), *view, x, y));
        }
    }
    EXPECT_EQ(pixels.size() * 4, batch.target.size());
}

TEST(Batch, RaysLeaveFromAnywhereInTheirPixels) {
    training::BatchSampler sampler(batch_capture(), 100, 8);
    glm::dvec2 sum(0), squares(0);
    double count = 0;
    while (count < 4000)
        for (const Tile& tile : sampler.next().tiles) {
            const glm::dvec2 jitter(glm::unpackSnorm2x16(tile.jitter));
            EXPECT_LE(std::max(std::abs(jitter.x), std::abs(jitter.y)), 0.5001);
            sum += jitter;
            squares += jitter * jitter;
            ++count;
        }
    for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(sum[axis] / count, 0, 0.03);  // 6 standard deviations
        EXPECT_NEAR(squares[axis] / count, 1.0 / 12, 0.008);
    }
}

TEST(Batch, TargetsAreTheImagesPremultipliedLinearLight) {
    training::BatchSampler sampler(batch_capture(), 100000, 7);
    const training::Batch batch = sampler.next();
    ASSERT_EQ(batch.target.size(), batch.tiles.size() * kTilePixels);
    ASSERT_EQ(batch.background.size(), batch.target.size());
    size_t beyond = 0, partial = 0;
    for (size_t i = 0; i < batch.target.size(); ++i) {
        const Tile& tile = batch.tiles[i / kTilePixels];
        const auto x = static_cast<uint32_t>(tile.x + i % kTile), y = static_cast<uint32_t>(tile.y + i % 64 / kTile);
        if (x >= kSize || y >= kSize) {
            ++beyond;
            EXPECT_EQ(batch.target[i].a, -1);
            continue;
        }
        const uint8_t* pixel = view_of(batch_capture(), batch.time, tile.camera).image.at(x, y);
        const double alpha = pixel[3] / 255.0;
        partial += alpha > 0 && alpha < 1 ? 1 : 0;
        ASSERT_NEAR(batch.target[i].a, alpha, 1e-6);
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(batch.target[i][c], alpha * media::linear_from_srgb(pixel[c] / 255.0), 1e-5);
        EXPECT_EQ(batch.background[i], batch.background[i - i % kTilePixels]) << "one colour a tile";
    }
    EXPECT_GT(beyond, 100u);
    EXPECT_GT(partial, 100u);
    EXPECT_NE(batch.background.front(), batch.background.back());
}

TEST(Batch, ACapturedPlateStandsBehindTheRays) {
    training::Dataset dataset = batch_capture();
    for (media::Image& plate : dataset.plates) {
        plate = media::Image(kSize, kSize);
        for (uint32_t i = 0; i < kSize * kSize * 4; ++i)
            plate.rgba[i] = static_cast<uint8_t>(i % 4 == 3 ? 255 : 60 + i % 101);
    }
    training::BatchSampler sampler(dataset, 100000, 8);
    const training::Batch batch = sampler.next();
    for (size_t i = 0; i < batch.target.size(); ++i) {
        if (batch.target[i].a < 0) continue;
        const Tile& tile = batch.tiles[i / kTilePixels];
        const auto x = static_cast<uint32_t>(tile.x + i % kTile), y = static_cast<uint32_t>(tile.y + i % 64 / kTile);
        const uint8_t* plate = dataset.plates[tile.camera].at(x, y);
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(batch.background[i][c], media::linear_from_srgb(plate[c] / 255.0), 1e-6);
        ASSERT_EQ(batch.target[i], training::foreground(dataset, view_of(dataset, batch.time, tile.camera), x, y));
    }
}

TEST(Batch, IgnoredPixelsTeachNothing) {
    training::Dataset dataset = batch_capture();
    for (training::View& view : dataset.views) {
        view.ignored.resize(kSize * kSize);
        for (uint32_t i = 0; i < kSize * kSize; ++i) view.ignored[i] = i % kSize < kSize / 2;
    }
    training::BatchSampler sampler(dataset, 100000, 8);
    const training::Batch batch = sampler.next();
    size_t known = 0;
    for (size_t i = 0; i < batch.target.size(); ++i) {
        const Tile& tile = batch.tiles[i / kTilePixels];
        const auto x = static_cast<uint32_t>(tile.x + i % kTile), y = static_cast<uint32_t>(tile.y + i % 64 / kTile);
        const bool lesson = x >= kSize / 2 && x < kSize && y < kSize;
        ASSERT_EQ(batch.target[i].a >= 0, lesson) << x << " " << y;
        known += lesson;
    }
    EXPECT_GT(known, 100u);
}

TEST(Batch, AnInstantWithoutMatterStillGivesABatch) {
    training::Dataset dataset = batch_capture();
    for (training::View& view : dataset.views) clear_image(view);
    training::BatchSampler sampler(dataset, 3, 9);
    for (int i = 0; i < 50; ++i) {
        const size_t tiles = sampler.next().tiles.size();
        EXPECT_GE(tiles, 1u);
        EXPECT_LE(tiles, 3u);
    }
}

}  // namespace
}  // namespace neuvv::test
