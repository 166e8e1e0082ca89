// Mattes by networks in ONNX files, which the tests write: a sphere is the redder the more opaque it is.
#include "training/mattes/network_mattes.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/input_error.h"
#include "support/matte_networks.h"
#include "support/sphere_capture.h"
#include "training/mattes/make_mattes.h"

namespace neuvv::test {
namespace {

constexpr int kWallRed = 60, kMoreRed = 150;  // of 255: the wall's at most, and what the sphere adds to it

// A network that sees red as R, of 0 to 255, less the mean, by the deviation.
RedNetwork seeing(float mean, float deviation, RedNetwork network) {
    network.weight = 255.0f * deviation / kMoreRed;
    network.bias = (255.0f * mean - kWallRed) / kMoreRed;
    return network;
}

// An image whose sphere is its alpha, before a wall. `striped`: the wall's red alone says nothing.
media::Image red_image(const media::Image& performer, bool striped) {
    media::Image image(performer.width, performer.height);
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        const bool dark = striped && (i / 4) % 10 < 5;
        image.rgba[i] = static_cast<uint8_t>((dark ? 0 : kWallRed) + performer.rgba[i + 3] * kMoreRed / 255);
        image.rgba[i + 1] = static_cast<uint8_t>(200 - i / 4 % 100);
        image.rgba[i + 2] = 130;
        image.rgba[i + 3] = 255;
    }
    return image;
}

struct NetworkMattes : ::testing::Test {
    TemporaryFolder folder;
    training::Dataset truth;
    training::MatteJob job{
        .dataset = folder.path / "data", .output = folder.path / "data/mattes", .model = folder.path / "red.onnx"};

    void write_dataset(const SphereCapture& capture, bool striped = false) {
        truth = sphere_dataset(capture);
        write_views(striped);
    }
    // Those views of the truth that are left.
    void write_views(bool striped = false) {
        training::Dataset seen = truth;
        for (training::View& view : seen.views) view.image.store(red_image(view.image.whole(), striped));
        std::filesystem::create_directories(job.output);
        write_capture(job.dataset, seen);
    }
    training::MatteSummary make(const std::string& onnx) {
        write_text(job.model, onnx);
        return training::make_mattes(job, {});
    }
    // The greatest difference of any pixel of this matte from an alpha.
    int worst(const training::View& view, const media::Image& alpha) const {
        const media::Image matte = media::read_png(job.output / (view.name + ".png"));
        int most = 0;
        for (size_t i = 0; i < matte.rgba.size(); i += 4)
            most = std::max(most, std::abs(int{matte.rgba[i]} - int{alpha.rgba[i + 3]}));
        return most;
    }
    // The mean difference over all mattes.
    double mean_difference() const {
        double sum = 0, count = 0;
        for (const training::View& view : truth.views) {
            const media::Image matte = media::read_png(job.output / (view.name + ".png")), alpha = view.image.whole();
            for (size_t i = 0; i < matte.rgba.size(); i += 4, ++count)
                sum += std::abs(int{matte.rgba[i]} - int{alpha.rgba[i + 3]});
        }
        return sum / count;
    }
};

const SphereCapture kTwoCameras{.cameras = 2, .frames = 3, .size = 96};

TEST_F(NetworkMattes, OfAnUnknownNetworkAreItsAlpha) {
    write_dataset(kTwoCameras);
    const training::MatteSummary made = make(onnx_of(seeing(0, 1, {})));
    EXPECT_EQ(made.images, 6u);
    EXPECT_TRUE(made.shows_performer);
    for (const training::View& view : truth.views) EXPECT_LE(worst(view, view.image.whole()), 2) << view.name;
    EXPECT_TRUE(std::filesystem::exists(job.output / "contact_sheet.png"));
}

// Each sees other numbers for the same red, in squares of another size.
TEST_F(NetworkMattes, OfKnownNetworksAreWhatTheirFamiliesSee) {
    write_dataset({.cameras = 1, .frames = 2, .size = 96});
    make(onnx_of(seeing(0.485f, 0.229f, {.size = {1, 3, 320, 320}, .image = "input.1", .alpha = "1959"})));
    EXPECT_LT(mean_difference(), 2) << "U²-Net";
    make(onnx_of(seeing(0.5f, 1, {.size = {1, 3, 1024, 1024}, .image = "input", .alpha = "2000"})));
    EXPECT_LT(mean_difference(), 2) << "IS-Net";
    make(onnx_of(seeing(0.5f, 0.5f, {.size = {1, 3, 64, 96}, .image = "input", .alpha = "output"})));
    EXPECT_LT(mean_difference(), 2) << "MODNet";
    make(
        onnx_of(seeing(0.485f, 0.229f, {.size = {1, 3, 1024, 1024}, .image = "input_image", .alpha = "output_image"})));
    EXPECT_LT(mean_difference(), 2) << "BiRefNet with its sigmoid";
    RedNetwork logits =
        seeing(0.485f, 0.229f, {.size = {1, 3, 1024, 1024}, .image = "input_image", .alpha = "output_image"});
    logits.weight *= 40;
    logits.bias = 40 * (logits.bias - 0.5f);
    make(onnx_of(logits));
    EXPECT_LT(mean_difference(), 3) << "BiRefNet";
}

TEST_F(NetworkMattes, OfImagesAndPlatesAreWhatDiffers) {
    write_dataset({.cameras = 2, .frames = 2, .size = 96}, true);
    RedNetwork difference{.image = "src", .alpha = "pha", .weight = 255.0f / kMoreRed, .plate = "bgr"};
    expect_input_error([&] { make(onnx_of(difference)); }, {"c00", "no clean plate", "2 images"});
    std::filesystem::create_directories(job.dataset / "plates");
    for (const char* camera : {"c00", "c01"})
        media::write_png(job.dataset / fmt::format("plates/{}.png", camera), red_image(media::Image(96, 96), true));
    for (const uint64_t side : {uint64_t{96}, uint64_t{0}}) {  // fixed, or left open
        difference.size = {1, 3, side, side};
        EXPECT_EQ(make(onnx_of(difference)).cameras_with_plate, 2u);
        for (const training::View& view : truth.views) EXPECT_LE(worst(view, view.image.whole()), 2) << view.name;
    }
}

TEST_F(NetworkMattes, OfFramesThatRememberTheLastBeginAnewWithEachCameraAndAfterAPause) {
    write_dataset({.cameras = 2, .frames = 8, .size = 96});
    std::erase_if(truth.views, [](const training::View& view) { return view.name == "c01_f004"; });
    write_views();
    for (const bool open : {false, true}) {
        make(late_network(seeing(0, 1, {}), open));
        const media::Image nothing(96, 96);
        for (size_t i = 0; i < truth.views.size(); ++i) {
            const std::string& name = truth.views[i].name;
            const bool first = name == "c00_f000" || name == "c01_f000" || name == "c01_f005";
            const media::Image before = first ? nothing : truth.views[i - 1].image.whole();
            EXPECT_LE(worst(truth.views[i], before), 2) << name;
            EXPECT_TRUE(first || worst(truth.views[i], truth.views[i].image.whole()) > 100) << "the sphere moves";
        }
    }
}

// A red rectangle that only one camera sees is nothing that the others show.
TEST_F(NetworkMattes, TellWhichCameraDisagrees) {
    write_dataset({.cameras = 10, .frames = 2, .size = 96});
    for (const training::View& view : truth.views) {
        if (view.camera != 3) continue;
        media::Image image = red_image(view.image.whole(), false);
        for (uint32_t y = 4; y < 30; ++y)
            for (uint32_t x = 2; x < 14; ++x) *image.at(x, y) = kWallRed + kMoreRed;
        media::write_png(job.dataset / (view.name + ".png"), image);
    }
    const training::MatteSummary made = make(onnx_of(seeing(0, 1, {})));
    ASSERT_EQ(made.agreements.size(), 10u);
    EXPECT_EQ(made.agreements[0].camera, "c03");
    EXPECT_GT(made.agreements[0].beyond, 0.1);
    EXPECT_LT(made.agreements[1].beyond, 0.05);
    EXPECT_LT(made.agreements[0].lacking, 0.1);
}

TEST_F(NetworkMattes, StopWhereTheyAreTold) {
    write_dataset(kTwoCameras);
    write_text(job.model, onnx_of(seeing(0, 1, {})));
    const auto until_two = [](uint64_t done, uint64_t total) {
        EXPECT_EQ(total, 6u);
        return done < 2;
    };
    EXPECT_EQ(training::make_mattes(job, until_two).images, 2u);
}

TEST_F(NetworkMattes, AreRefusedWhereANetworkGivesNoAlpha) {
    write_dataset(kTwoCameras);
    const auto refuse = [&](const RedNetwork& network, std::initializer_list<std::string> parts) {
        const std::string onnx = onnx_of(network);
        expect_input_error([&] { make(onnx); }, parts);
        EXPECT_TRUE(std::filesystem::is_empty(job.output)) << "nothing is written";
    };
    refuse({.last_operation = "AveragePool"}, {"red.onnx", "opacity", "1×1×48×48, not 1×1×96×96"});
    refuse({.bias = -9, .last_operation = "Log"}, {"red.onnx", "opacity", "nan", "c00_f000"});
    refuse({.weight = 50}, {"red.onnx", "not from 0 to 1", "sigmoid"});
    refuse({.last_operation = "Conjure"}, {"red.onnx", "cannot be opened", "OpenCV"});
    refuse({.size = {1, 4, 96, 96}}, {"red.onnx", "picture 1×4×96×96", "MODNet"});
    refuse({.size = {1, 3, 96, 1 << 20}}, {"red.onnx", "larger"});
    write_text(job.model, "no network");
    expect_input_error([&] { training::make_mattes(job, {}); }, {"red.onnx", "no ONNX model"});
    job.model = folder.path / "none.onnx";
    expect_input_error([&] { training::make_mattes(job, {}); }, {"none.onnx"});
}

}  // namespace
}  // namespace neuvv::test
