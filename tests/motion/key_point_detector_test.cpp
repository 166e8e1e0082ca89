// Key points by networks in ONNX files, which the tests write: each answers to the colours of markers.
#include "motion/video/key_point_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "motion/colour_model.h"
#include "motion/network/network.h"
#include "motion/video/person_crop.h"
#include "support/input_error.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

using motion::KeyPointDetector;
using motion::PixelScale;

struct KeyPointDetectorTest : testing::Test {
    TemporaryFolder folder;

    std::filesystem::path written(const std::string& bytes) const {
        write_text(folder.path / "model.onnx", bytes);
        return folder.path / "model.onnx";
    }
    std::filesystem::path written(const test::ColourModel& model) const { return written(test::onnx_of(model)); }
};

// Markers of all key points in a part of an image, apart from each other.
struct Marked {
    media::Image image;
    std::vector<glm::dvec2> centres;
};
Marked marked(uint32_t width, uint32_t height, size_t key_points, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> across(60, width - 60), down(60, height - 60);
    Marked made{test::grey_image(width, height), {}};
    while (made.centres.size() < key_points) {
        const glm::dvec2 centre(across(random), down(random));
        if (std::ranges::any_of(made.centres, [&](const glm::dvec2& m) { return glm::distance(m, centre) < 80; }))
            continue;
        test::draw_marker(made.image, made.centres.size(), key_points, centre, 16);
        made.centres.push_back(centre);
    }
    return made;
}

void expect_found(KeyPointDetector& detector, const Marked& marked, double pixels) {
    const std::vector<motion::KeyPoint> found = detector.detect(marked.image);
    ASSERT_EQ(found.size(), marked.centres.size());
    for (size_t k = 0; k < found.size(); ++k) {
        EXPECT_LT(glm::distance(found[k].pixel, marked.centres[k]), pixels)
            << k << ": " << found[k].pixel.x << ' ' << found[k].pixel.y;
        EXPECT_GT(found[k].confidence, 0.7) << k;
        EXPECT_LE(found[k].confidence, 1.0) << k;
    }
}

TEST_F(KeyPointDetectorTest, FindsMarkersInHeatMaps) {
    for (const size_t key_points : {17u, 26u})
        for (const PixelScale scale : {PixelScale::kImageNet, PixelScale::kUnit, PixelScale::kBytes}) {
            KeyPointDetector detector(written(test::ColourModel{.key_points = key_points, .scale = scale}), scale);
            EXPECT_EQ(detector.layout().points, key_points);
            expect_found(detector, marked(700, 900, key_points, 3), 0.5);
        }
}

TEST_F(KeyPointDetectorTest, FindsMarkersInAnyPartOfAnImage) {
    KeyPointDetector detector(written(test::ColourModel{}), PixelScale::kImageNet);
    expect_found(detector, marked(1000, 400, 17, 4), 1);  // wide: the crop has bars above and below
    expect_found(detector, marked(400, 1000, 17, 5), 1);  // high: and beside
    // A performer who stands in a part of the image is enlarged.
    const Marked small = marked(600, 700, 17, 6);
    Marked large{test::grey_image(1800, 1300), small.centres};
    for (uint32_t y = 0; y < 700; ++y) std::copy_n(small.image.at(0, y), size_t{4} * 600, large.image.at(900, y + 70));
    for (glm::dvec2& centre : large.centres) centre += glm::dvec2(900, 70);
    expect_found(detector, large, 0.5);
}

TEST_F(KeyPointDetectorTest, FindsMarkersInColumnsAndRows) {
    for (const bool columns_last : {false, true}) {
        test::ColourModel model{.pool = 1, .simcc = true, .columns_last = columns_last};
        KeyPointDetector detector(written(model), PixelScale::kImageNet);
        expect_found(detector, marked(700, 900, 17, 7), 1);
    }
}

TEST_F(KeyPointDetectorTest, TheBatchMayBeOpen) {
    KeyPointDetector detector(written(test::ColourModel{.input = {0, 3, 384, 288}}), PixelScale::kImageNet);
    expect_found(detector, marked(700, 900, 17, 3), 0.5);
}

TEST_F(KeyPointDetectorTest, SeesNobodyInABackground) {
    KeyPointDetector detector(written(test::ColourModel{}), PixelScale::kImageNet);
    EXPECT_TRUE(detector.detect(test::grey_image(300, 200)).empty());
    EXPECT_TRUE(detector.detect(media::Image(300, 200)).empty());
    EXPECT_TRUE(detector.detect(media::Image()).empty());
    Marked pixel{test::grey_image(300, 200), {}};
    *pixel.image.at(7, 9) = 255;
    EXPECT_EQ(detector.detect(pixel.image).size(), 17u);
}

TEST_F(KeyPointDetectorTest, RefusesWhatItCannotRun) {
    const auto refuse = [&](const test::ColourModel& model, std::initializer_list<std::string> parts) {
        const auto file = written(model);
        expect_input_error([&] { KeyPointDetector(file, PixelScale::kUnit); }, parts);
    };
    refuse({.key_points = 20}, {"1×20×96×72", "20 key points", "COCO-17"});
    refuse({.input = {1, 3, 0, 192}}, {"graph.input", "1×3×0×192", "fixed size"});
    refuse({.input = {1, 4, 256, 192}}, {"1×4×256×192"});
    refuse({.input = {2, 3, 256, 192}}, {"2×3×256×192"});
    refuse({.input = {1, 3, 100000, 192}}, {"1×3×100000×192"});
    refuse({.input = {1, 3, 192}}, {"1×3×192"});
    refuse({.first_operation = "Conjure"}, {"cannot be opened", "OpenCV"});
    refuse({.pool = 512}, {"cannot be"});
    expect_input_error([&] { KeyPointDetector(folder.path / "none.onnx", PixelScale::kUnit); }, {"none.onnx"});
    expect_input_error([&] { KeyPointDetector(folder.path, PixelScale::kUnit); }, {folder.path.string()});
}

TEST_F(KeyPointDetectorTest, RefusesDamagedFiles) {
    const std::string whole = test::onnx_of(test::ColourModel{.input = {1, 3, 64, 64}});
    const auto refuse = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
        const auto file = written(bytes);
        expect_input_error([&] { KeyPointDetector(file, PixelScale::kUnit); }, parts);
    };
    refuse("", {"model.onnx", "no ONNX model"});
    refuse("{\"people\": []}", {"model.onnx", "no ONNX model"});
    // The graph is all but the first bytes and the last.
    for (size_t size = 3; size < whole.size() - 10; size += 7) refuse(whole.substr(0, size), {"model.onnx", "ONNX"});
    // One number less or more than the weights' sizes say.
    std::string other = whole;
    const size_t sizes = other.find("\x08\x11\x08\x03\x08\x01");  // 17×3×1…
    ASSERT_NE(sizes, std::string::npos);
    other[sizes + 1] = 16;
    refuse(other, {"model.onnx", "has not the 48 numbers"});
    other[sizes + 1] = 18;
    refuse(other, {"model.onnx", "has not the 54 numbers"});
}

// A file with any byte changed is read to its end or refused in one line; ASan watches.
TEST(OnnxFile, SurvivesDamage) {
    const std::string whole = test::onnx_of(test::ColourModel{});
    std::mt19937 random(1);
    size_t refused = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string damaged = whole;
        for (int k = 0; k < 2; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
        try {
            const motion::OnnxFile onnx = motion::parse_onnx({damaged.begin(), damaged.end()}, "a.onnx");
            for (const motion::OnnxValue& input : onnx.inputs) {
                uint64_t elements = 1;
                for (const uint64_t size : input.sizes) elements *= std::max<uint64_t>(size, 1);
                EXPECT_LE(elements, motion::kMaxInputElements);
            }
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(refused, 1000u);
}

TEST(PersonBox, IsWhatDiffersFromTheBackground) {
    media::Image clear(50, 40);
    for (uint32_t x = 10; x < 20; ++x) clear.at(x, 30)[3] = 255;
    auto box = motion::person_box(clear);
    ASSERT_TRUE(box);
    EXPECT_EQ(box->low, glm::dvec2(10, 30));
    EXPECT_EQ(box->high, glm::dvec2(20, 31));
    media::Image grey = test::grey_image(50, 40);
    *grey.at(5, 6) = 0;
    box = motion::person_box(grey);
    ASSERT_TRUE(box);
    EXPECT_EQ(box->low, glm::dvec2(5, 6));
    EXPECT_EQ(box->high, glm::dvec2(6, 7));
    *grey.at(0, 20) = 0;  // a border of several colours: a room
    box = motion::person_box(grey);
    ASSERT_TRUE(box);
    EXPECT_EQ(box->high, glm::dvec2(50, 40));
}

TEST(PersonCrop, KeepsTheShapeAndAddsAQuarter) {
    const media::Image image = test::grey_image(100, 100);
    const motion::PersonCrop crop = motion::crop_person(image, {{20, 10}, {40, 90}}, 192, 256);
    EXPECT_NEAR(crop.scale, 80 * 1.25 / 256, 1e-12);
    const glm::dvec2 centre = crop.image_pixel({96, 128});
    EXPECT_NEAR(centre.x, 30, 1e-12);
    EXPECT_NEAR(centre.y, 50, 1e-12);
    for (const float value : crop.rgb) ASSERT_EQ(value, 124);
}

}  // namespace
}  // namespace neuvv
