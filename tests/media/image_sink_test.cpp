// Where the images of a render are written, and how a render is resumed.
#include "media/image_sink.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

media::Image image_of(uint8_t grey) {
    media::Image image(16, 8);
    for (size_t i = 0; i < image.rgba.size(); ++i)
        image.rgba[i] = i % 4 == 3 ? 255 : static_cast<uint8_t>(grey + i / 4);
    return image;
}

struct Sink : testing::Test {
    TemporaryFolder folder;
    media::RenderFacts facts{{"scene", "xxh3:0123"}, {"--size", "16x8"}};

    media::ImageSink sink(const char* name, bool resume) {
        return {media::parse_output((folder.path / name).string()), {16, 8}, 25, facts, resume};
    }
    bool there(const char* name) const { return std::filesystem::exists(folder.path / name); }
};

TEST_F(Sink, NumberedImagesGoOnWhereTheyStopped) {
    {
        media::ImageSink first = sink("o_%02d.png", false);
        EXPECT_TRUE(first.resumable());
        EXPECT_FALSE(first.has(0));
        for (uint32_t i = 0; i < 3; ++i) first.add(i, image_of(static_cast<uint8_t>(10 * i)));
    }  // interrupted
    EXPECT_TRUE(there("o_render.json"));
    media::write_png(folder.path / "o_03.png", image_of(99));  // an image of another render
    std::filesystem::remove(folder.path / "o_01.png");         // an image that was deleted
    media::ImageSink second = sink("o_%02d.png", true);
    EXPECT_TRUE(second.has(0));
    EXPECT_FALSE(second.has(1));
    EXPECT_TRUE(second.has(2));
    EXPECT_FALSE(second.has(3));
    second.add(1, image_of(10));
    second.add(3, image_of(30));
    second.finish(4);
    for (uint8_t i = 0; i < 4; ++i)
        EXPECT_EQ(media::read_png(folder.path / ("o_0" + std::to_string(i) + ".png")).rgba,
                  image_of(static_cast<uint8_t>(10 * i)).rgba);
    const media::ImageSink third = sink("o_%02d.png", true);
    for (uint32_t i = 0; i < 4; ++i) EXPECT_TRUE(third.has(i));
}

TEST_F(Sink, WithoutResumeNothingIsKept) {
    sink("o_%d.png", false).add(0, image_of(1));
    EXPECT_FALSE(sink("o_%d.png", false).has(0));
    EXPECT_FALSE(sink("o_%d.png", true).has(0)) << "the second render had not finished it";
}

// A shorter render leaves no images of a longer one behind its end; files that no render recorded stay.
TEST_F(Sink, AShorterRenderRemovesTheRestOfALongerOne) {
    const auto render = [&](uint32_t images) {
        media::ImageSink out = sink("s_%d.png", false);
        for (uint32_t i = 0; i < images; ++i) out.add(i, image_of(static_cast<uint8_t>(i)));
        out.finish(images);
        return out.removed();
    };
    EXPECT_EQ(render(5), 0u);
    write_text(folder.path / "s_7.png", "mine");
    facts["images"] = "3";
    EXPECT_EQ(render(3), 2u);
    for (const auto& [name, is_there] :
         {std::pair("s_2.png", true), {"s_3.png", false}, {"s_4.png", false}, {"s_7.png", true}})
        EXPECT_EQ(std::filesystem::exists(folder.path / name), is_there) << name;
    EXPECT_EQ(render(3), 0u);
}

TEST_F(Sink, TwoRendersAreNotMixed) {
    sink("o_%d.png", false).add(0, image_of(1));
    facts["--size"] = "32x16";
    expect_input_error([&] { sink("o_%d.png", true); }, {"o_render.json", "--size", "16x8", "32x16", "render anew"});
    facts["--size"] = "16x8";
    facts["scene"] = "xxh3:4567";
    facts["images"] = "12";  // which follows from the change
    expect_input_error([&] { sink("o_%d.png", true); }, {"o_render.json", "scene: was changed since"});
    facts["scene"] = "xxh3:0123";
    facts.erase("images");
    facts["--alpha"] = "true";
    expect_input_error([&] { sink("o_%d.png", true); }, {"o_render.json", "--alpha", "none", "true"});
    facts.erase("--alpha");
    EXPECT_TRUE(sink("o_%d.png", true).has(0));
}

TEST_F(Sink, DamagedRecordsAreNamed) {
    for (const char* text : {"", "{", "[]", "{\"finished\": 1}", "{\"render\": 3, \"finished\": 1}",
                             "{\"render\": {\"scene\": 5}, \"finished\": 1}", "{\"render\": {}, \"finished\": -1}",
                             "{\"render\": {}, \"finished\": \"x\"}"}) {
        write_text(folder.path / "o_render.json", text);
        expect_input_error([&] { sink("o_%d.png", true); }, {"o_render.json"});
    }
}

// A percent sign is a place for the number in the name of a file alone, and there only before a d.
TEST(ImageOutput, OnlyTheNameOfAFileHasAPlaceForTheNumber) {
    using Kind = media::ImageOutput::Kind;
    for (const char* still : {"take 50%dry/still.png", "50%.png", "a/50%/%s.exr", "100%%.png"}) {
        EXPECT_EQ(media::parse_output(still).kind, Kind::kImage) << still;
        EXPECT_EQ(media::parse_output(still).file(7), still);
    }
    const media::ImageOutput dry = media::parse_output("take 50%dry/x%_%04d.exr");
    EXPECT_EQ(dry.kind, Kind::kNumberedImages);
    EXPECT_EQ(dry.file(7), "take 50%dry/x%_0007.exr");
    EXPECT_EQ(dry.deep_file(7), "take 50%dry/x%_deep_0007.exr");
    EXPECT_EQ(media::parse_output("%d/%d.png").file(12), "%d/12.png");
    EXPECT_EQ(media::parse_output("50%dry/a.mp4").kind, Kind::kVideo);
    const TemporaryFolder folder;
    expect_input_error([&] { media::parse_output((folder.path / "shot_%04d" / "a.png").string()); },
                       {"%04d in the name of a folder", "out_%04d.png"});
    std::filesystem::create_directory(folder.path / "shot_%04d");
    EXPECT_EQ(media::parse_output((folder.path / "shot_%04d" / "a.png").string()).kind, Kind::kImage);
    for (const char* wrong : {"a_%4d.png", "a_%00d.png", "a_%012d.png", "%d_%d.png", "%04d_%04d.exr"})
        expect_input_error([&] { media::parse_output(wrong); }, {wrong, "one place"});
}

TEST_F(Sink, VideosKeepTheirImagesWhereAsked) {
    const auto fill = [](media::ImageSink& into, uint32_t from, uint32_t to) {
        for (uint32_t i = from; i < to; ++i) into.add(i, image_of(static_cast<uint8_t>(20 * i)));
    };
    media::ImageSink straight = sink("straight.mp4", false);
    EXPECT_FALSE(straight.resumable());
    fill(straight, 0, 5);
    straight.finish(5);
    EXPECT_EQ(folder.entries(), 1u);
    {
        media::ImageSink first = sink("100%.mp4", true);  // a path may have a percent sign
        fill(first, 0, 2);
    }
    EXPECT_TRUE(there("100%.mp4.frames"));
    media::ImageSink second = sink("100%.mp4", true);
    EXPECT_TRUE(second.has(1));
    EXPECT_FALSE(second.has(2));
    fill(second, 2, 5);
    second.finish(5);
    EXPECT_EQ(folder.entries(), 2u) << "the kept images are gone";
    media::VideoReader a(folder.path / "straight.mp4"), b(folder.path / "100%.mp4");
    media::Image of_a, of_b;
    for (int i = 0; i < 5; ++i) {
        ASSERT_TRUE(a.next(of_a) && b.next(of_b));
        EXPECT_EQ(of_a.rgba, of_b.rgba) << i;
    }
    EXPECT_FALSE(b.next(of_b));
}

// Two processes that each write a part of the numbered images have a record each.
TEST_F(Sink, PartsOfNumberedImagesGoOnByThemselves) {
    const auto part = [&](const media::ImageRange& range, bool resume) {
        return media::ImageSink(media::parse_output((folder.path / "o_%02d.png").string()), {16, 8}, 25, facts, resume,
                                range);
    };
    {
        media::ImageSink first = part({0, 3}, false), second = part({3, 6}, false);
        second.add(3, image_of(3));
        first.add(0, image_of(0));
    }  // both are interrupted
    EXPECT_TRUE(part({3, 6}, true).has(3));
    EXPECT_FALSE(part({3, 6}, true).has(4));
    EXPECT_FALSE(part({3, 6}, true).has(0)) << "not of this part";
    EXPECT_FALSE(part({0, 3}, true).has(1));
    EXPECT_FALSE(part({3, 7}, true).has(3)) << "another part has a record of its own";
    EXPECT_TRUE(there("o_render_3-6.json"));
}

// Images of another render, whole or in parts, do not count as those of this one.
TEST_F(Sink, PartsAndTheWholeDoNotMix) {
    const auto part = [&](bool resume) {
        return media::ImageSink(media::parse_output((folder.path / "o_%02d.png").string()), {16, 8}, 25, facts, resume,
                                media::ImageRange{0, 2});
    };
    write_text(folder.path / "o_render_notes.json", "mine");
    {
        media::ImageSink whole = sink("o_%02d.png", false);
        whole.add(0, image_of(1));
        whole.add(1, image_of(2));
    }
    EXPECT_TRUE(sink("o_%02d.png", true).has(1));
    part(false);
    EXPECT_TRUE(there("o_render.json")) << "it is of the same images";
    facts["--size"] = "8x8";
    expect_input_error([&] { part(true); }, {"o_render", "--size"});
    part(false);
    EXPECT_FALSE(there("o_render.json"));
    facts["--size"] = "16x8";
    expect_input_error([&] { sink("o_%02d.png", true); }, {"o_render_0-2.json", "--size"});
    media::forget_renders(media::parse_output((folder.path / "o_%02d.png").string()));
    EXPECT_FALSE(sink("o_%02d.png", true).has(1));
    EXPECT_FALSE(there("o_render_0-2.json"));
    EXPECT_EQ(read_text(folder.path / "o_render_notes.json"), "mine");
}

TEST_F(Sink, FilesOfOthersBesideKeptImagesStay) {
    media::ImageSink video = sink("v.mp4", true);
    write_text(folder.path / "v.mp4.frames/notes.txt", "mine");
    video.add(0, image_of(0));
    video.finish(1);
    EXPECT_EQ(read_text(folder.path / "v.mp4.frames/notes.txt"), "mine");
    EXPECT_FALSE(there("v.mp4.frames/000000.png"));
}

// Images are encoded by several threads, and may end in any order.
TEST_F(Sink, TheRecordNamesOnlyWhatIsThere) {
    constexpr uint32_t kImages = 60;
    media::ImageSink into = sink("o_%02d.png", false);
    for (uint32_t i = 0; i < kImages; ++i) {
        into.add(i, i % 7 == 0 ? media::Image(900, 900) : image_of(static_cast<uint8_t>(i)));
        const auto finished =
            nlohmann::json::parse(read_text(folder.path / "o_render.json")).at("finished").get<uint32_t>();
        EXPECT_LE(finished, i + 1);
        for (uint32_t there = finished - std::min(finished, 8u); there < finished; ++there)
            EXPECT_GT(media::read_png(folder.path / fmt::format("o_{:02}.png", there)).width, 0u);
    }
    into.finish(kImages);
    const media::ImageSink again = sink("o_%02d.png", true);
    for (uint32_t i = 0; i < kImages; ++i) EXPECT_TRUE(again.has(i)) << i;
}

TEST_F(Sink, WhatCannotBeWrittenIsReportedLater) {
    std::filesystem::create_directory(folder.path / "gone");
    media::ImageSink into = sink("gone/o_%02d.png", false);
    std::filesystem::remove_all(folder.path / "gone");
    into.add(0, image_of(0));
    EXPECT_THROW(into.finish(1), RuntimeFailure);
    EXPECT_THROW(into.add(1, image_of(1)), RuntimeFailure);
}

TEST_F(Sink, LinearImages) {
    media::ImageSink into = sink("o_%d.exr", false);
    EXPECT_TRUE(into.exr());
    const media::LinearImage image{2, 1, {0.5f, 0.25f, 0, 1, 0, 0, 0, 0}, {1.5f, 2}};
    into.add(0, image);
    into.finish(1);
    EXPECT_EQ(media::read_exr(folder.path / "o_0.exr").rgba, image.rgba);
    EXPECT_TRUE(sink("o_%d.exr", true).has(0));
}

TEST_F(Sink, ContentIsWhatCounts) {
    write_text(folder.path / "a", "content");
    write_text(folder.path / "b", "content");
    write_text(folder.path / "c", "Content");
    EXPECT_EQ(media::content_fact(folder.path / "a"), media::content_fact(folder.path / "b"));
    EXPECT_NE(media::content_fact(folder.path / "a"), media::content_fact(folder.path / "c"));
    expect_input_error([&] { media::content_fact(folder.path / "none"); }, {"none"});
}

}  // namespace
}  // namespace neuvv
