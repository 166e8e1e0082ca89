#include "tools/options.h"
#include "base/output_path.h"

#include <gtest/gtest.h>

#include "media/image.h"
#include "media/image_sink.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"
#include "tools/report.h"

namespace neuvv {
namespace {

TEST(Options, Size) {
    const media::ImageSize size = tools::parse_size("1280x720");
    EXPECT_EQ(size.width, 1280u);
    EXPECT_EQ(size.height, 720u);
    for (const char* text : {"", "x", "640", "640x", "x480", "0x10", "10x0", "-1x10", "10x10x10", "10 x10", "10x10 ",
                             "16385x1", "4294967297x1", "1e3x10", "10X10"})
        expect_input_error([&] { tools::parse_size(text); }, {"--size", text, "1280x720"});
}

TEST(Options, Colour) {
    const auto parse = [](const std::string& text) { return tools::parse_colour("--colour", text); };
    EXPECT_EQ(parse("clear"), glm::vec4(0));
    EXPECT_EQ(parse("white"), glm::vec4(1));
    EXPECT_EQ(parse("BLACK"), glm::vec4(0, 0, 0, 1));
    EXPECT_EQ(parse("red"), glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(parse("Aqua"), glm::vec4(0, 1, 1, 1));
    EXPECT_EQ(parse("gray"), parse("#808080"));
    EXPECT_EQ(parse("olive"), parse("#808000"));
    for (const char* text : {"#ff8000", "ff8000", "#FF8000"}) {
        const glm::vec4 colour = parse(text);
        EXPECT_EQ(colour.r, 1);
        EXPECT_NEAR(colour.g, media::linear_from_srgb(128 / 255.0), 1e-6);
        EXPECT_EQ(colour.b, 0);
        EXPECT_EQ(colour.a, 1);
    }
    for (const char* text : {"", "#", "blurple", "#fff", "#ff80000", "##f8000", "#gg0000", "0xff80"})
        expect_input_error([&] { parse(text); }, {"--colour", "#rrggbb", "fuchsia", "clear"});
}

TEST(Options, FrameRange) {
    const auto expect_range = [](const char* text, double first, double last) {
        const tools::FrameRange range = tools::parse_frame_range(text, 24);
        EXPECT_EQ(range.first, first) << text;
        EXPECT_EQ(range.last, last) << text;
    };
    expect_range("", 0, 23);
    expect_range(":", 0, 23);
    expect_range("3:", 3, 23);
    expect_range(":7.5", 0, 7.5);
    expect_range("2.25:4", 2.25, 4);
    expect_range("11", 11, 11);
    expect_range("23:23", 23, 23);
    for (const char* text : {"a", "1:b", "-1:3", "3:2", "0:24", "23.5", "nan", "0:nan", "inf", "1:2:3", "1,2", " 1"})
        expect_input_error([&] { tools::parse_frame_range(text, 24); }, {"--frames", "0:23"});
}

TEST(Options, Output) {
    EXPECT_EQ(media::parse_output("a/b.mp4").kind, media::ImageOutput::Kind::kVideo);
    EXPECT_EQ(media::parse_output("50%.mp4").file(3), "50%.mp4");
    EXPECT_EQ(media::parse_output("b.PNG").kind, media::ImageOutput::Kind::kImage);
    EXPECT_EQ(media::parse_output("a/out_%04d.png").file(7), "a/out_0007.png");
    EXPECT_EQ(media::parse_output("a/out_%04d.png").file(123456), "a/out_123456.png");
    EXPECT_EQ(media::parse_output("%d.png").file(12), "12.png");
    EXPECT_EQ(media::parse_output("a/out_%04d.png").file("render"), "a/out_render.png");
    EXPECT_FALSE(media::parse_output("out_%04d.png").exr);
    EXPECT_TRUE(media::parse_output("out_%04d.EXR").exr);
    EXPECT_EQ(media::parse_output("out_%04d.exr").file(7), "out_0007.exr");
    EXPECT_EQ(media::parse_output("out.exr").kind, media::ImageOutput::Kind::kImage);
    for (const char* text : {"", "out", "out.avi", "mp4", "out.mp4.tmp"})
        expect_input_error([&] { media::parse_output(text); }, {"output: ", "out_%04d.png"});
    for (const char* text : {"%s.png", "%04.png", "%%.png", "%.png"}) {  // names as any other
        EXPECT_EQ(media::parse_output(text).kind, media::ImageOutput::Kind::kImage) << text;
        EXPECT_EQ(media::parse_output(text).file(3), text);
    }
    EXPECT_EQ(media::parse_output("%n_%d.png").file(7), "%n_7.png");
    for (const char* text : {"%d_%d.png", "%0d.png", "%00d.png", "%4d.png", "%010d.png", "%04"})
        expect_input_error([&] { media::parse_output(text); }, {"output: ", text});
}

TEST(Options, OutputsAreCheckedBeforeWork) {
    const TemporaryFolder folder;
    prepare_output_file("--json", folder.path / "a/b/c.json");
    EXPECT_TRUE(std::filesystem::is_directory(folder.path / "a/b"));
    EXPECT_FALSE(std::filesystem::exists(folder.path / "a/b/c.json"));
    prepare_output_file("--json", "c.json");  // in the working directory
    expect_input_error([&] { prepare_output_file("--json", folder.path / "a/b"); }, {"--json", "a/b"});
    expect_input_error([&] { prepare_output_file("--json", folder.path / "a/"); }, {"--json", "a/"});
    write_text(folder.path / "wall", "a file where a folder should be");
    expect_input_error([&] { prepare_output_file("--html", folder.path / "wall/x.html"); }, {"--html", "wall"});
    expect_input_error([&] { prepare_output_folder("--images", folder.path / "wall"); }, {"--images", "wall"});
}

TEST(Options, Texts) {
    EXPECT_EQ(tools::size_text(999), "999 B");
    EXPECT_EQ(tools::size_text(12'345'678), "12.3 MB");
    EXPECT_EQ(tools::format_duration(4.21), "4.2 s");
    EXPECT_EQ(tools::format_duration(125.4), "2:05");
    EXPECT_EQ(tools::format_duration(3723), "1:02:03");
}

TEST(Options, FramesAreCountedInSecondsToo) {
    EXPECT_EQ(tools::parse_frames("--to", "24", 0), 24u);
    EXPECT_EQ(tools::parse_frames("--to", "1.5s", 30), 45u);
    EXPECT_EQ(tools::parse_frames("--to", "2:10", 25), 3250u);
    EXPECT_EQ(tools::parse_frames("--to", "0:00.04", 25), 1u);
    for (const char* text : {"", "s", ":", "1:", "2:1s", "-1", "1:2:3", "20000000", "nans"})
        expect_input_error([&] { tools::parse_frames("--to", text, 25); }, {"--to"});
    expect_input_error([&] { tools::parse_frames("--to", "1s", 0); }, {"--to", "frame rate"});
}

}  // namespace
}  // namespace neuvv
