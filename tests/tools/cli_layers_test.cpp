// neuvv render for compositing: ProRes with alpha, and the layers of .exr files.
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include "media/exr.h"
#include "media/image_sink.h"
#include "media/sound.h"
#include "media/video.h"
#include "support/read_deep.h"
#include "support/wav_file.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

struct CliLayers : CliGpu {
    std::string show = file("show.gltf");

    static void done(const std::vector<std::string>& call) {
        const ProgramResult run = run_neuvv(call);
        ASSERT_EQ(run.code, 0) << run.err;
    }
    void write_show() {
        done({"stage", "new", show});
        done({"stage", "add", show, scene, "--name", "anna", "--time", "loop"});
        done({"stage", "add", show, scene, "--name", "berta", "--time", "loop", "--at", "0.3,0.2,0.1"});
    }
    void render(const std::string& what, const char* output, const std::vector<std::string>& more) const {
        std::vector<std::string> call = {"render", "--overwrite", what, "-o", file(output), "--size", "64x48"};
        call.insert(call.end(), more.begin(), more.end());
        done(call);
    }
};

// The largest differences of alpha, and of colours over black, in steps of 255.
std::pair<double, double> difference(const media::Image& a, const media::Image& b) {
    std::pair<double, double> worst{0, 0};
    for (size_t p = 0; p < a.rgba.size(); p += 4) {
        worst.first = std::max(worst.first, std::abs(1.0 * a.rgba[p + 3] - b.rgba[p + 3]));
        for (size_t c = 0; c < 3; ++c)
            worst.second = std::max(
                worst.second, std::abs(a.rgba[p + c] * a.rgba[p + 3] / 255.0 - b.rgba[p + c] * b.rgba[p + 3] / 255.0));
    }
    return worst;
}

TEST_F(CliLayers, AMovShowsTheImagesOfTheSameFramesWithAlpha) {
    render(scene, "o_%d.png", {});
    render(scene, "one.mov", {});
    render(scene, "parts.mov", {"--part", "2/2"});
    render(scene, "parts.mov", {"--part", "1/2"});
    EXPECT_FALSE(std::filesystem::exists(file("parts.mov.parts")));
    render(scene, "resumed.mov", {"--resume"});
    for (const char* video : {"one.mov", "parts.mov", "resumed.mov"}) {
        media::VideoReader reader(file(video));
        EXPECT_EQ(reader.frames(), 8u);
        media::Image seen;
        bool clear = false, solid = false;
        for (uint32_t i = 0; reader.next(seen); ++i) {
            const media::Image truth = media::read_png(media::parse_output(file("o_%d.png")).file(i));
            const auto [alpha, colour] = difference(seen, truth);
            EXPECT_LE(alpha, 1) << video << " " << i;
            EXPECT_LE(colour, 3) << video << " " << i;
            for (size_t p = 3; p < seen.rgba.size(); p += 4) {
                clear |= seen.rgba[p] == 0;
                solid |= seen.rgba[p] > 200;
            }
        }
        EXPECT_TRUE(clear && solid);
    }
    expect_refused({"render", scene, "-o", file("x.mp4"), "--background", "clear"}, 2, {"no transparency", "out.mov"});
}

TEST_F(CliLayers, AMovOfAStageHasSoundAndAlpha) {
    test::write_wav(file("tone.wav"), test::stereo_tone(2 * media::kSoundRate), 2, media::kSoundRate);
    write_show();
    done({"stage", "set", show, "anna", "--sound", file("tone.wav")});
    render(show, "show.mov", {"--time", "0:1", "--fps", "4", "--background", "clear"});
    EXPECT_NEAR(media::read_sound(file("show.mov")).length_s(), 1, 0.05);
    media::VideoReader reader(file("show.mov"));
    EXPECT_EQ(reader.frames(), 4u);
    media::Image seen;
    ASSERT_TRUE(reader.next(seen));
    EXPECT_EQ(seen.at(0, 0)[3], 0) << "above the floor";
    EXPECT_EQ(seen.at(32, 47)[3], 255) << "the floor";
}

TEST_F(CliLayers, DeepSamplesOfAStageAreItsFlatImage) {
    write_show();
    render(show, "s.exr", {"--time", "0.5", "--background", "clear", "--layers", "rgba,depth,ids,deep"});
    const media::LinearImage flat = media::read_exr(file("s.exr"));
    const media::DeepImage deep = test::read_deep(file("s_deep.exr"));
    ASSERT_EQ(deep.counts.size(), flat.depth_m.size());
    double worst = 0, nearest = 0;
    size_t floor = 0;
    auto sample = deep.samples.begin();
    for (size_t i = 0; i < deep.counts.size(); ++i) {
        double sum[4] = {}, last_m = 0;
        for (const auto end = sample + deep.counts[i]; sample != end; ++sample) {
            const double through = 1 - sum[3];
            for (size_t c = 0; c < 4; ++c) sum[c] += through * double{sample->rgba[c]};
            EXPECT_LE(last_m, double{sample->near_m});
            last_m = double{sample->far_m};
        }
        for (size_t c = 0; c < 4; ++c)
            worst = std::max(
                worst, std::abs(sum[c] - double{flat.rgba[4 * i + c]}) / std::max(1.0, double{flat.rgba[4 * i + c]}));
        if (deep.counts[i] == 0) continue;
        floor += deep.counts[i] <= 4;  // a surface for each ray
        nearest = std::max(nearest, double{flat.depth_m[i]} - last_m);
    }
    EXPECT_LE(worst, 1.0 / 512) << "halves have 11 bits";
    EXPECT_LE(nearest, 1e-3) << "no depth of the flat image lies behind all samples";
    EXPECT_GT(floor, 100u);
    const Imf::InputFile file_of(file("s.exr").c_str());
    const auto* manifest = file_of.header().findTypedAttribute<Imf::StringAttribute>("cryptomatte/3ae39a5/manifest");
    ASSERT_TRUE(manifest);
    for (const char* name : {"\"anna\"", "\"berta\"", "\"set\""})
        EXPECT_NE(manifest->value().find(name), std::string::npos) << name;
}

TEST_F(CliLayers, LayersAreThoseThatWereAskedFor) {
    render(scene, "d_%02d.exr",
           {"--frames", "0:3", "--fps", "1", "--layers", "depth,deep", "--resume", "--samples", "1"});
    EXPECT_TRUE(std::filesystem::exists(file("d_deep_03.exr")));
    const Imf::InputFile flat(file("d_00.exr").c_str());
    EXPECT_TRUE(flat.header().channels().findChannel("Z"));
    EXPECT_FALSE(flat.header().channels().findChannel("R"));
    std::filesystem::remove(file("d_deep_01.exr"));
    render(scene, "d_%02d.exr",
           {"--frames", "0:3", "--fps", "1", "--layers", "depth,deep", "--resume", "--samples", "1"});
    EXPECT_TRUE(std::filesystem::exists(file("d_deep_01.exr"))) << "what is missing is rendered again";
    const auto refused = [&](const char* output, const std::vector<std::string>& more, const char* word) {
        std::vector<std::string> call = {"render", "--overwrite", scene, "-o", file(output), "--frames", "0"};
        call.insert(call.end(), more.begin(), more.end());
        expect_refused(call, 2, {"--layers", word});
    };
    refused("x.exr", {"--layers", "rgb"}, "there is no layer \"rgb\"");
    refused("x.exr", {"--layers", "deep"}, "add rgba");
    refused("x.png", {"--layers", "ids"}, "name out.exr");
    refused("x.exr", {"--layers", "rgba,ids", "--direct"}, "--direct");
    write_show();
    expect_refused({"render", show, "-o", file("x.exr"), "--layers", "rgba,ids", "--blend", "paper"}, 2,
                   {"--layers", "--blend exact"});
}

}  // namespace
}  // namespace neuvv
