// Difference mattes against known ones: a sphere in front of a noisy wall. Also the files that make_mattes writes.
#include "training/mattes/difference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "media/jpeg.h"
#include "support/input_error.h"
#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/data/plate.h"
#include "training/mattes/make_mattes.h"

namespace neuvv::test {
namespace {

// The sphere is seen from the side, so that no pixel shows it in many frames.
const SphereCapture kCapture{
    .cameras = 2, .frames = 9, .size = 96, .radius_m = 0.22, .travel_m = 0.8, .first_angle = 1.5};

// A wall with a pattern of stripes and checks, from dark to bright.
media::Image wall(uint32_t side) {
    media::Image image(side, side);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t check = (x / 12 + y / 12) % 2;
            image.at(x, y)[0] = static_cast<uint8_t>(30 + 60 * check);
            image.at(x, y)[1] = static_cast<uint8_t>(40 + 40 * check + x / 3);
            image.at(x, y)[2] = static_cast<uint8_t>(70 + y / 4);
            image.at(x, y)[3] = 255;
        }
    return image;
}

// What a camera in front of the wall records: both mixed in linear light, with noise of about `sigma` steps, brighter
// by `exposure` steps.
media::Image seen(const media::Image& performer, const media::Image& background, double sigma, int exposure,
                  uint64_t seed) {
    Random random(seed);
    media::Image image = background;
    for (size_t i = 0; i < image.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        const double alpha = performer.rgba[i | 3] / 255.0;
        const double light = alpha * media::linear_from_srgb(performer.rgba[i] / 255.0) +
                             (1 - alpha) * media::linear_from_srgb(background.rgba[i] / 255.0);
        double noise = -6;  // the sum of twelve uniform numbers has nearly a normal distribution
        for (int k = 0; k < 12; ++k) noise += static_cast<double>(random.below(1000)) / 999;
        image.rgba[i] = static_cast<uint8_t>(
            std::clamp(std::lround(255 * media::srgb_from_linear(light) + sigma * noise + exposure), 0l, 255l));
    }
    return image;
}

struct Agreement {
    double iou = 0;  // intersection over union of the pixels that are more than half performer
    double mae = 0;  // mean absolute error of alpha, over the image
};

Agreement agreement(const std::vector<uint8_t>& matte, const media::Image& truth) {
    double both = 0, either = 0, error = 0;
    for (size_t i = 0; i < matte.size(); ++i) {
        const bool a = matte[i] > 127, b = truth.rgba[4 * i + 3] > 127;
        both += a && b;
        either += a || b;
        error += std::abs(int{matte[i]} - int{truth.rgba[4 * i + 3]}) / 255.0;
    }
    return {both / std::max(either, 1.0), error / static_cast<double>(matte.size())};
}

// The capture as ordinary cameras record it: opaque, in front of the wall.
training::Dataset opaque_capture(const training::Dataset& truth, double sigma) {
    training::Dataset dataset = truth;
    for (size_t i = 0; i < dataset.views.size(); ++i)
        dataset.views[i].image.store(seen(truth.views[i].image.whole(), wall(kCapture.size), sigma, 0, i));
    return dataset;
}

TEST(Matte, FindsThePerformerBeforeACleanPlate) {
    const training::Dataset truth = sphere_dataset(kCapture);
    for (const double sigma : {0.0, 1.0, 3.0})
        for (const size_t view : {0, 4, 12}) {
            SCOPED_TRACE(sigma);
            const media::Image performer = truth.views[view].image.whole();
            const media::Image plate = seen(media::Image(96, 96), wall(96), sigma, 0, 100);
            const media::Image image = seen(performer, wall(96), sigma, 0, view);
            const Agreement found =
                agreement(training::difference_matte(image, plate, training::BackgroundKind::kPlate, {}), performer);
            EXPECT_GT(found.iou, sigma > 2 ? 0.93 : 0.97);
            EXPECT_LT(found.mae, sigma > 2 ? 0.006 : 0.003);
        }
}

TEST(Matte, ADriftOfTheExposureIsNoPerformer) {
    const training::Dataset truth = sphere_dataset(kCapture);
    const media::Image performer = truth.views[3].image.whole();
    const media::Image image = seen(performer, wall(96), 1, 15, 5),
                       plate = seen(media::Image(96, 96), wall(96), 1, 0, 6);
    EXPECT_GT(agreement(training::difference_matte(image, plate, training::BackgroundKind::kPlate, {}), performer).iou,
              0.95);
}

// The image with its light multiplied by `light_at` the distance from its middle, in pixels.
template <typename Light>
media::Image darkened(media::Image image, const Light& light_at) {
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c) {
                uint8_t& value = image.at(x, y)[c];
                const double distance = std::hypot(x - 0.5 * image.width, y - 0.5 * image.height);
                value = media::srgb_byte_from_linear(static_cast<float>(light_at(distance)) *
                                                     media::linear_from_srgb_byte(value));
            }
    return image;
}

TEST(Matte, ASoftShadowIsNoPerformerButDarkClothIs) {
    constexpr uint32_t kSide = 320;
    const media::Image nobody(kSide, kSide), plate = seen(nobody, wall(kSide), 1, 0, 1);
    const auto matte_of = [&](const auto& light_at) {
        return training::difference_matte(seen(nobody, darkened(wall(kSide), light_at), 1, 0, 2), plate,
                                          training::BackgroundKind::kPlate, {});
    };
    const auto soft = [](double distance) { return 1 - 0.5 * std::clamp((120 - distance) / 100, 0.0, 1.0); };
    const std::vector<uint8_t> shadow = matte_of(soft);
    EXPECT_EQ(std::accumulate(shadow.begin(), shadow.end(), 0u), 0u);
    media::Image disc(kSide, kSide);
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x)
            disc.at(x, y)[3] = std::hypot(x - 0.5 * kSide, y - 0.5 * kSide) < 70 ? 255 : 0;
    const auto cloth = [](double distance) { return distance < 70 ? 0.5 : 1.0; };
    EXPECT_GT(agreement(matte_of(cloth), disc).iou, 0.95);
    // Cloth of the wall's hue, shaded softly from its middle, which is as light as the wall.
    const auto round = [](double distance) { return distance < 70 ? 1 - 0.75 * (distance / 70) : 1.0; };
    EXPECT_GT(agreement(matte_of(round), disc).iou, 0.9);
}

TEST(Matte, FringesOfCompressionAreNoPerformer) {
    constexpr uint32_t kSide = 320;
    const auto recorded = [](const media::Image& image) {
        const std::vector<uint8_t> bytes = media::encode_jpeg(image, 85);
        return media::decode_image(bytes.data(), bytes.size(), "it");
    };
    SphereCapture capture = kCapture;
    capture.size = kSide;
    const media::Image performer = sphere_dataset(capture).views[4].image.whole();
    const media::Image plate = recorded(seen(media::Image(kSide, kSide), wall(kSide), 1, 0, 1));
    const media::Image image = recorded(seen(performer, wall(kSide), 1, 0, 2));
    EXPECT_GT(agreement(training::difference_matte(image, plate, training::BackgroundKind::kPlate, {}), performer).iou,
              0.95);
}

TEST(Matte, NothingIsFoundWhereNothingIs) {
    const media::Image a = seen(media::Image(96, 96), wall(96), 2, 0, 1),
                       b = seen(media::Image(96, 96), wall(96), 2, 0, 2);
    const std::vector<uint8_t> matte = training::difference_matte(a, b, training::BackgroundKind::kPlate, {});
    EXPECT_EQ(std::accumulate(matte.begin(), matte.end(), 0u), 0u);
}

TEST(Matte, EdgesAreSoft) {
    media::Image plate(40, 40), image(40, 40);  // black; the image has a white square whose left column is half covered
    for (uint32_t y = 10; y < 30; ++y)
        for (uint32_t x = 10; x < 30; ++x)
            std::fill_n(image.at(x, y), 3,
                        static_cast<uint8_t>(x == 10 ? std::lround(255 * media::srgb_from_linear(0.5)) : 255));
    const std::vector<uint8_t> matte = training::difference_matte(image, plate, training::BackgroundKind::kPlate, {});
    EXPECT_NEAR(matte[20 * 40 + 10], 128, 2);
    EXPECT_EQ(matte[20 * 40 + 11], 255);
    EXPECT_EQ(matte[20 * 40 + 29], 255);
    EXPECT_EQ(matte[20 * 40 + 9], 0);
}

TEST(Matte, SpecksAreDroppedAndHolesClosed) {
    media::Image plate(100, 100), image(100, 100);
    const auto paint = [&](uint32_t left, uint32_t top, uint32_t side, uint8_t value) {
        for (uint32_t y = top; y < top + side; ++y)
            for (uint32_t x = left; x < left + side; ++x) std::fill_n(image.at(x, y), 3, value);
    };
    paint(30, 30, 40, 200);
    paint(45, 45, 4, 0);   // a button in the background's colour: 16 of 10,000 pixels
    paint(55, 55, 10, 0);  // a gap between arm and body
    paint(5, 5, 2, 200);   // an insect
    const std::vector<uint8_t> matte = training::difference_matte(image, plate, training::BackgroundKind::kPlate, {});
    EXPECT_EQ(matte[46 * 100 + 46], 255);
    EXPECT_EQ(matte[60 * 100 + 60], 0);
    EXPECT_EQ(matte[5 * 100 + 5], 0);
    EXPECT_EQ(matte[35 * 100 + 35], 255);
}

TEST(Matte, TheMedianForgetsWhoPassesBy) {
    const training::Dataset truth = sphere_dataset(kCapture);
    std::vector<media::Image> frames;
    for (size_t i = 0; i < 9; ++i) frames.push_back(seen(truth.views[i].image.whole(), wall(96), 0, 0, i));
    EXPECT_EQ(training::median_background(frames).rgba, wall(96).rgba);
    EXPECT_NE(training::median_background({frames[0], frames[0], frames[1]}).rgba, wall(96).rgba);
}

struct MatteFiles : ::testing::Test {
    TemporaryFolder folder;
    training::Dataset truth = sphere_dataset(kCapture);
    training::MatteJob job{.dataset = folder.path / "data", .output = folder.path / "data/mattes"};

    void SetUp() override {
        write_text(job.dataset / "readme", "");
        write_capture(job.dataset, opaque_capture(truth, 1));
        std::filesystem::create_directories(job.output);
    }
    // The worst agreement of all images that load_dataset reads.
    Agreement loaded_agreement() const {
        Agreement worst{1, 0};
        const training::Dataset loaded = training::load_dataset(job.dataset, training::Split::kTrain);
        EXPECT_EQ(loaded.views.size(), truth.views.size());
        for (size_t i = 0; i < loaded.views.size(); ++i) {
            std::vector<uint8_t> alpha;
            const media::Image image = loaded.views[i].image.whole();
            for (size_t k = 3; k < image.rgba.size(); k += 4) alpha.push_back(image.rgba[k]);
            const Agreement found = agreement(alpha, truth.views[i].image.whole());
            worst = {std::min(worst.iou, found.iou), std::max(worst.mae, found.mae)};
        }
        return worst;
    }
};

TEST_F(MatteFiles, AreWhatTrainingReads) {
    std::filesystem::remove(job.output);
    expect_input_error([&] { training::load_dataset(job.dataset, training::Split::kTrain); }, {"matte"});
    EXPECT_EQ(training::count_existing_mattes(job), 0u);
    std::filesystem::create_directories(job.output);
    uint64_t calls = 0;
    const training::MatteSummary summary = training::make_mattes(job, [&](uint64_t done, uint64_t total) {
        ++calls;
        EXPECT_LE(done, total);
        EXPECT_EQ(total, 18u);
        return true;
    });
    EXPECT_EQ(summary.images, 18u);
    EXPECT_EQ(summary.cameras, 2u);
    EXPECT_EQ(summary.cameras_with_plate, 0u);
    EXPECT_NE(summary.missing_split.words().find("transforms_test.json"), std::string::npos)
        << summary.missing_split.words();
    EXPECT_GE(calls, 2u);
    EXPECT_EQ(training::count_existing_mattes(job), 18u);
    EXPECT_GT(loaded_agreement().iou, 0.95);
    EXPECT_LT(loaded_agreement().mae, 0.003);
    EXPECT_EQ(media::read_png(job.output / "contact_sheet.png").width, 3u * 288u)
        << "images of 96 pixels, three times as large";
}

TEST_F(MatteFiles, AreTakenFromAnotherProgram) {
    job.from = folder.path / "foreign";
    std::filesystem::create_directories(job.from);
    expect_input_error([&] { training::make_mattes(job, {}); }, {"foreign", "c00_f000"});
    for (const training::View& view : truth.views)
        media::write_png(job.from / (view.name + ".png"), view.image.whole());
    training::make_mattes(job, {});
    EXPECT_EQ(loaded_agreement().iou, 1);
    EXPECT_EQ(loaded_agreement().mae, 0);
    media::Image grey(96, 96);  // its brightness counts, as it has no alpha
    for (uint8_t& byte : grey.rgba) byte = 255;
    for (uint32_t x = 0; x < 50; ++x) std::fill_n(grey.at(x, 0), 3, uint8_t{77});
    for (const training::View& view : truth.views) media::write_png(job.from / (view.name + ".png"), grey);
    training::make_mattes(job, {});
    EXPECT_EQ(media::read_png(job.output / "c00_f000.png").at(49, 0)[0], 77);
    EXPECT_EQ(media::read_png(job.output / "c00_f000.png").at(50, 0)[0], 255);
    EXPECT_GT(training::make_mattes(job, {}).white_borders, 0.8);
    job.inverted = true;
    EXPECT_LT(training::make_mattes(job, {}).white_borders, 0.2);
    EXPECT_EQ(media::read_png(job.output / "c00_f000.png").at(49, 0)[0], 178);
    EXPECT_EQ(media::read_png(job.output / "c00_f000.png").at(50, 0)[0], 0);
    media::write_png(job.from / "c01_f003.png", media::Image(96, 95));
    expect_input_error([&] { training::make_mattes(job, {}); }, {"c01_f003", "96×95"});
}

// What somebody corrected is not overruled unasked, under whichever name it lies.
TEST_F(MatteFiles, ThoseOfFormerNamesAreThere) {
    ASSERT_EQ(training::count_existing_mattes(job), 0u);
    media::write_png(job.output / "c00_c00_f000.png", media::Image(96, 96));
    media::write_png(job.output / "c01_f003.png", media::Image(96, 96));
    EXPECT_EQ(training::count_existing_mattes(job), 2u);
}

TEST_F(MatteFiles, TooFewImagesAreRefused) {
    training::Dataset few = opaque_capture(truth, 1);
    few.views.resize(4);
    write_capture(job.dataset, few);
    expect_input_error([&] { training::make_mattes(job, {}); }, {"clean plate", "4 images"});
    expect_input_error([&] { training::make_mattes({.dataset = folder.path / "none"}, {}); }, {"none"});
}

TEST_F(MatteFiles, StopWhereTheyAreTold) {
    EXPECT_EQ(training::make_mattes(job, [](uint64_t done, uint64_t) { return done == 0; }).images, 9u);
    EXPECT_EQ(training::make_mattes(job, [](uint64_t, uint64_t) { return false; }).images, 0u);
}

}  // namespace
}  // namespace neuvv::test
