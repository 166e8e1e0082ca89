// The simulated studio does what its file says, and nothing to what is held out.
#include "training/capture/studio.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "media/jpeg.h"
#include "media/psnr.h"
#include "tests/support/input_error.h"
#include "tests/support/temporary_folder.h"
#include "training/capture/capture.h"
#include "training/capture/floor_shadow.h"
#include "training/data/dataset.h"
#include "training/data/images.h"
#include "training/data/layouts/formats.h"
#include "training/tree/camera_check.h"
#include "training/tree/doubtful_mattes.h"
#include "training/tree/hull_box.h"

namespace neuvv {
namespace {

constexpr uint32_t kStudioFrames = 10;

std::vector<bool> every_fifth_held_out() {
    std::vector<bool> held_out(15);
    for (size_t c = 2; c < held_out.size(); c += 5) held_out[c] = true;
    return held_out;
}

media::Image grey_scene(uint8_t value) {
    media::Image scene(64, 48);
    std::ranges::fill(scene.rgba, value);
    return scene;
}

// The mean and the deviation of a channel's linear light in a rectangle.
std::pair<double, double> light_in(const media::Image& image, int channel, uint32_t x0, uint32_t y0, uint32_t side) {
    double sum = 0, squares = 0;
    for (uint32_t y = y0; y < y0 + side; ++y)
        for (uint32_t x = x0; x < x0 + side; ++x) {
            const auto light = static_cast<double>(media::linear_from_srgb_byte(image.at(x, y)[channel]));
            sum += light;
            squares += light * light;
        }
    const double count = side * side, mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean))};
}

TEST(Studio, ConfusesFourCamerasAndAHundredthOfTheMattes) {
    const std::vector<bool> held_out = every_fifth_held_out();
    std::set<std::pair<size_t, size_t>> pairs;
    for (uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        const training::Studio studio = training::make_studio(seed, held_out, 100);
        std::set<size_t> swapped, wrong_plates;
        for (size_t c = 0; c < studio.cameras.size(); ++c) {
            const training::StudioCamera& camera = studio.cameras[c];
            EXPECT_EQ(camera.held_out, held_out[c]);
            EXPECT_EQ(studio.cameras[camera.filed_as].filed_as, c);
            if (camera.filed_as != c) swapped.insert(c);
            if (camera.plate_fault != training::PlateFault::kNone) wrong_plates.insert(c);
            EXPECT_TRUE(camera.plate_fault != training::PlateFault::kOfAnotherCamera || camera.plate_of != c);
            for (const double gain : camera.gains) EXPECT_TRUE(gain >= 0.7 && gain <= 1.4);
            const double corner = 1 + camera.vignette[0] + camera.vignette[1];
            EXPECT_TRUE(held_out[c] ? corner == 1 : corner > 0.59 && corner < 0.91) << corner;
            EXPECT_FALSE(held_out[c] && (swapped.contains(c) || wrong_plates.contains(c)));
        }
        EXPECT_EQ(swapped.size(), 2u);
        EXPECT_EQ(wrong_plates.size(), 2u);
        for (const size_t c : swapped) EXPECT_FALSE(wrong_plates.contains(c));
        EXPECT_EQ(studio.wrong_mattes.size(), 12u) << "of 12 cameras × 100 frames";
        for (const training::WrongMatte& wrong : studio.wrong_mattes) EXPECT_FALSE(held_out[wrong.camera]);
        pairs.emplace(*swapped.begin(), *swapped.rbegin());
    }
    EXPECT_GT(pairs.size(), 20u) << "seeds differ";
}

// The numbers of one seed, so that a change of compiler or library cannot change what a seed means.
TEST(Studio, ASeedMeansTheSameEverywhere) {
    const training::Studio studio = training::make_studio(7, every_fifth_held_out(), kStudioFrames);
    EXPECT_EQ(studio.cameras[0].gains, (std::array<double, 3>{1.228, 1.365, 0.782}));
    std::vector<size_t> filed_as;
    for (const training::StudioCamera& camera : studio.cameras) filed_as.push_back(camera.filed_as);
    EXPECT_EQ(filed_as, (std::vector<size_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 10, 9, 12, 13, 14}));
    const media::Image noise = training::record(studio, 0, 3, grey_scene(128));
    uint64_t sum = 0;
    for (size_t i = 0; i < noise.rgba.size(); ++i) sum = sum * 31 + noise.rgba[i];
    EXPECT_EQ(sum, 16440801120168349081u);
}

TEST(Studio, ACameraHasGainsVignettingAndNoise) {
    training::Studio studio = training::make_studio(7, every_fifth_held_out(), kStudioFrames);
    studio.cameras[0].gains = {0.7, 1, 1.4};
    studio.cameras[0].vignette = {-0.2, -0.1};
    const media::Image scene = grey_scene(128), recorded = training::record(studio, 0, 0, scene);
    EXPECT_EQ(recorded.rgba, training::record(studio, 0, 0, scene).rgba);
    EXPECT_NE(recorded.rgba, training::record(studio, 0, 1, scene).rgba) << "each image has noise of its own";
    const double light = media::linear_from_srgb(128 / 255.0), deviation = std::sqrt(light * 6000 + 36) / 6000;
    for (int c = 0; c < 3; ++c) {
        const double gain = studio.cameras[0].gains[static_cast<size_t>(c)];
        const auto [middle, noise] = light_in(recorded, c, 26, 18, 12);
        EXPECT_NEAR(middle, gain * light, 0.01 * light);
        EXPECT_NEAR(noise, gain * deviation, 0.2 * gain * deviation);
        const double x = 2.0 * 4 - 64, y = 2.0 * 4 - 48, r2 = (x * x + y * y) / (64.0 * 64 + 48 * 48);  // at (4, 4)
        EXPECT_NEAR(light_in(recorded, c, 0, 0, 8).first, gain * light * (1 - 0.2 * r2 - 0.1 * r2 * r2), 0.01 * light);
    }
}

TEST(Studio, JpegFilesKeepTheImage) {
    media::Image image(33, 21);
    for (uint32_t y = 0; y < 21; ++y)
        for (uint32_t x = 0; x < 33; ++x) {
            const uint8_t rgba[] = {static_cast<uint8_t>(5 * x), static_cast<uint8_t>(9 * y), 90, 7};
            std::copy_n(rgba, 4, image.at(x, y));
        }
    const auto worst_at = [&](int quality) {
        const std::vector<uint8_t> bytes = media::encode_jpeg(image, quality);
        const media::Image read = media::decode_image(bytes.data(), bytes.size(), "it");
        EXPECT_TRUE(read.width == 33 && read.height == 21 && read.rgba[3] == 255);
        int worst = 0;
        for (size_t i = 0; i < read.rgba.size(); ++i)
            if (i % 4 != 3) worst = std::max(worst, std::abs(int{read.rgba[i]} - int{image.rgba[i]}));
        return worst;
    };
    EXPECT_LT(worst_at(95), 8);
    EXPECT_GT(worst_at(5), 8);
}

// Somebody with a square outline stands below the lamp.
TEST(Studio, TheFloorHasASoftShadow) {
    const training::Backdrop room{{-2, 0, -2}, {2, 3, 2}, 0.25};
    stage::Camera camera;
    camera.fx = camera.fy = 100;
    camera.cx = camera.cy = 50;
    camera.width = camera.height = 100;
    const stage::Camera lamp = training::lamp_above(camera, {0, 0, 0}, 2.5);
    std::vector<glm::vec4> seen(100 * 100);
    for (size_t i = 0; i < seen.size(); ++i)
        if (i % 100 / 20 == 2 && i / 100 / 20 == 2) seen[i].a = 1;  // half a metre along either side of the floor
    const training::FloorShadow shadow(lamp, seen);
    EXPECT_NEAR(shadow.light_at({0, 0, 0}), 0.5, 0.01);
    EXPECT_NEAR(shadow.light_at({0.25, 0, 0}), 0.75, 0.06) << "at the outline";
    EXPECT_EQ(shadow.light_at({0.9, 0, 0}), 1);
    EXPECT_EQ(shadow.light_at({9, 0, 0}), 1) << "outside of what the lamp sees";
    camera.world_from_camera[3] = glm::dvec4(0, 0.3, 1.5, 1);  // looks along the floor at a wall
    const media::Image plate = training::clean_plate(room, camera);
    const media::Image dark = training::shaded(plate, room, camera, shadow);
    EXPECT_EQ(std::vector<uint8_t>(dark.rgba.begin(), dark.rgba.begin() + 50 * 400),
              std::vector<uint8_t>(plate.rgba.begin(), plate.rgba.begin() + 50 * 400))
        << "the wall has none";
    const uint8_t below = plate.at(50, 70)[0], shaded = dark.at(50, 70)[0];  // of the floor's middle
    EXPECT_NEAR(media::linear_from_srgb_byte(shaded) / media::linear_from_srgb_byte(below), 0.5, 0.03);
}

struct StudioCapture : testing::Test {
    TemporaryFolder folder;
    training::CaptureSettings settings;
    const std::filesystem::path model = NEUVV_SOURCE_DIR "/tools/performer/performer.glb";

    StudioCapture() {
        settings.cameras = 10;
        settings.frames = kStudioFrames;
        settings.width = settings.height = 64;
        settings.holdout = 0.2;
        settings.background = training::CaptureBackground::kChecker;
    }
    std::filesystem::path take(const std::string& name) const {
        static const gpu::Device device("", gpu::Validation::kOn);
        EXPECT_TRUE(training::capture(device, model, folder.path / name, settings, nullptr).complete);
        EXPECT_EQ(device.drain_validation_messages(), std::vector<std::string>());
        return folder.path / name;
    }
};

// The matte that a file has, against the capture without a studio.
std::map<std::string, media::Image> images_by_name(const training::Dataset& dataset) {
    std::map<std::string, media::Image> images;
    for (const training::View& view : dataset.views) images[view.name] = view.image.whole();
    return images;
}

bool same_alpha(const media::Image& a, const media::Image& b) {
    for (size_t i = 3; i < a.rgba.size(); i += 4)
        if (a.rgba[i] != b.rgba[i]) return false;
    return true;
}

TEST_F(StudioCapture, HeldOutViewsAreThoseOfACleanCapture) {
    const std::filesystem::path clean = take("clean");
    settings.studio = 3;
    const std::filesystem::path studio = take("studio");
    EXPECT_EQ(read_text(studio / "transforms_test.json"), read_text(clean / "transforms_test.json"));
    const training::Dataset truth = training::load_dataset(clean, training::Split::kTest);
    const training::Dataset found = training::load_dataset(studio, training::Split::kTest);
    ASSERT_EQ(found.views.size(), 2u * kStudioFrames);
    for (size_t i = 0; i < found.views.size(); ++i) EXPECT_EQ(found.views[i].image, truth.views[i].image);
    for (const uint32_t c : {0u, 1u}) EXPECT_EQ(found.plates[c].rgba, truth.plates[c].rgba);
}

TEST_F(StudioCapture, IsAsItsFileSays) {
    const auto clean = images_by_name(training::load_dataset(take("clean"), training::Split::kTrain));
    settings.studio = 3;
    const std::filesystem::path path = take("studio");
    const auto truth = nlohmann::json::parse(read_text(path / training::kStudioTruth));
    const training::Dataset dataset = training::load_dataset(path, training::Split::kTrain);
    ASSERT_EQ(dataset.cameras.size(), 8u);
    std::map<std::string, std::string> camera_of_name;
    for (const auto& camera : truth["cameras"])
        if (!camera["held_out"]) camera_of_name[camera["images_are_called"]] = camera["name"];
    std::set<std::string> wrong, expected_wrong;
    for (const auto& matte : truth["wrong_mattes"]) expected_wrong.insert(matte["file"]);
    EXPECT_EQ(expected_wrong.size(), 1u) << "1 % of 80";
    for (const auto& [name, image] : images_by_name(dataset)) {
        const std::string shown = camera_of_name.at(name.substr(0, 3)) + name.substr(3);
        if (!same_alpha(image, clean.at(shown))) wrong.insert(name);
    }
    EXPECT_EQ(wrong, expected_wrong);
    EXPECT_EQ(truth["swapped"].size(), 2u);
    for (const std::string name : truth["swapped"])
        EXPECT_FALSE(same_alpha(images_by_name(dataset).at(name + "_f000"), clean.at(name + "_f000")));
    size_t missing = 0, plates = 0;
    for (const auto& camera : truth["cameras"]) missing += camera.value("plate", "") == "missing" ? 1 : 0;
    for (const media::Image& plate : dataset.plates) plates += plate.width > 0 ? 1 : 0;
    EXPECT_EQ(plates, 8 - missing);
}

// Which cells of a grid may hold matter, at all times.
std::vector<uint32_t> hull_bits(const training::Dataset& dataset) {
    return training::carve(dataset, training::grid_cells(training::first_box(dataset), training::kBoxGrid));
}

// The share of the cells of either hull that both have.
double common_share(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    int both = 0, either = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        both += std::popcount(a[i] & b[i]);
        either += std::popcount(a[i] | b[i]);
    }
    return static_cast<double>(both) / std::max(either, 1);
}

// The shares of the clean capture's hull that a studio's capture has: as its files are, with doubtful mattes ignored,
// and with the cameras checked before that.
std::array<double, 3> hull_shares(const std::filesystem::path& clean, const std::filesystem::path& studio) {
    const std::vector<uint32_t> truth = hull_bits(training::load_dataset(clean, training::Split::kTrain));
    training::Dataset dataset = training::load_dataset(studio, training::Split::kTrain);
    std::array<double, 3> shares = {common_share(truth, hull_bits(dataset))};
    training::ignore_doubtful_mattes(dataset);
    shares[1] = common_share(truth, hull_bits(dataset));
    training::Rig rig = training::read_rig(studio, training::Split::kTrain);
    training::check_cameras(rig);
    dataset = training::read_images(rig, {});
    training::ignore_doubtful_mattes(dataset);
    shares[2] = common_share(truth, hull_bits(dataset));
    return shares;
}

TEST_F(StudioCapture, TheHullIsThatOfTheCleanCapture) {
    const std::filesystem::path clean = take("clean");
    for (const uint64_t seed : {1u, 2u, 3u, 4u}) {
        SCOPED_TRACE(seed);
        settings.studio = seed;
        const auto [as_filed, repaired, checked] = hull_shares(clean, take(fmt::format("studio{}", seed)));
        std::printf("seed %d: %.3f as filed, %.3f without doubtful mattes, %.3f with cameras checked\n",
                    static_cast<int>(seed), as_filed, repaired, checked);
        EXPECT_LT(as_filed, 0.9);
        EXPECT_GT(checked, 0.97);
    }
}

TEST_F(StudioCapture, VideosAreFiledAsImagesAre) {
    settings.studio = 3;
    const std::filesystem::path of_images = take("images");
    const training::Dataset images = training::load_dataset(of_images, training::Split::kTrain);
    settings.videos = true;
    const std::filesystem::path path = take("videos");
    EXPECT_FALSE(std::filesystem::exists(path / "mattes"));
    EXPECT_EQ(nlohmann::json::parse(read_text(path / training::kStudioTruth))["wrong_mattes"].size(), 0u);
    const training::Dataset videos = training::load_dataset(path, training::Split::kTrain, {.mattes_needed = false});
    ASSERT_EQ(videos.views.size(), images.views.size());
    for (size_t i = 0; i < images.views.size(); ++i) {
        SCOPED_TRACE(images.views[i].name);
        EXPECT_EQ(videos.cameras[videos.views[i].camera].world_from_camera,
                  images.cameras[images.views[i].camera].world_from_camera);
        EXPECT_DOUBLE_EQ(videos.views[i].time, images.views[i].time);
        const std::vector<uint8_t> bytes = read_file(of_images / "images" / (images.views[i].name + ".jpg"));
        const media::Image file = media::decode_image(bytes.data(), bytes.size(), images.views[i].name);
        EXPECT_GT(media::psnr_db(file, videos.views[i].image.whole()), 25);
    }
    for (size_t c = 0; c < images.plates.size(); ++c) EXPECT_EQ(videos.plates[c].rgba, images.plates[c].rgba);
}

TEST_F(StudioCapture, AStudioNeedsCameras) {
    settings.studio = 3;
    settings.cameras = 6;
    expect_input_error([&] { take("few"); }, {"cameras: ", "5 that train", "so that 6 train"});
    EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace neuvv
