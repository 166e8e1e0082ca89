// Segmented clips: their index, what is read of it, and which frame lies where.
#include "voctree/files/clip_index.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/output_path.h"
#include "support/input_error.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_box.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

class ClipIndexTest : public testing::Test {
  protected:
    void write_index(const std::string& text) { write_text_file(clip / "clip.json", text); }
    voctree::VOctree write_segment(const std::string& name, uint32_t frames, glm::vec3 low) {
        voctree::VOctree tree = random_tree({.frames = frames});
        tree.box_min = low;
        voctree::write_nvv(clip / name, tree);
        return tree;
    }

    TemporaryFolder folder;
    std::filesystem::path clip = [this] {
        std::filesystem::create_directory(folder.path / "show.nvv");
        return folder.path / "show.nvv";
    }();
};

TEST_F(ClipIndexTest, WhatIsWrittenIsRead) {
    EXPECT_FALSE(voctree::is_segmented(clip)) << "without clip.json it is a folder like others";
    const voctree::ClipIndex index{
        29.97f, {{clip / voctree::segment_file_name(0), 0, 4, 1}, {clip / voctree::segment_file_name(4), 4, 3}}};
    voctree::write_clip_index(clip, index);
    EXPECT_TRUE(voctree::is_segmented(clip));
    const voctree::ClipIndex read = voctree::read_clip_index(clip);
    EXPECT_EQ(read.fps, 29.97f);
    EXPECT_EQ(read.frames(), 7u);
    ASSERT_EQ(read.segments.size(), 2u);
    EXPECT_EQ(read.segments[1].file, clip / "000004.nvv");
    EXPECT_EQ(read.segments[1].first, 4u);
    EXPECT_EQ(read.segments[1].frames, 3u);
    EXPECT_EQ(read.segments[0].overlap, 1u);
    EXPECT_EQ(read.segments[1].overlap, 0u);
    EXPECT_NE(read_text(clip / "clip.json").find("\"neuvv_clip\": 2"), std::string::npos);
    voctree::write_clip_index(clip, {25, {{clip / "a.nvv", 0, 4}}});
    EXPECT_NE(read_text(clip / "clip.json").find("\"neuvv_clip\": 1"), std::string::npos)
        << "older programs play a clip without overlap";
}

TEST_F(ClipIndexTest, AFileIsOneSegment) {
    const voctree::VOctree tree = write_segment("alone.nvv", 5, {0, 0, 0});
    const voctree::ClipIndex index = voctree::read_clip_index(clip / "alone.nvv");
    ASSERT_EQ(index.segments.size(), 1u);
    EXPECT_EQ(index.segments[0].file, clip / "alone.nvv");
    EXPECT_EQ(index.frames(), 5u);
    EXPECT_EQ(index.fps, tree.fps);
}

TEST_F(ClipIndexTest, TheHeadHoldsAllSegments) {
    write_segment("a.nvv", 2, {-1, 0, 0});
    const voctree::VOctree far = write_segment("b.nvv", 3, {4, 1, 0});
    write_index(R"({"neuvv_clip": 1, "fps": 30, "segments": [{"file": "a.nvv", "frames": 2},
                    {"file": "b.nvv", "frames": 3}, {"file": "lost.nvv", "frames": 4}]})");
    const voctree::ClipHeader header = voctree::read_clip_header(clip);
    EXPECT_EQ(header.frames, 9u) << "a segment that is missing has its frames";
    EXPECT_EQ(header.fps, 30);
    EXPECT_EQ(header.box_min, glm::vec3(-1, 0, 0));
    EXPECT_EQ(header.box_min + header.box_size, glm::vec3(4, 1, 0) + far.box_size);
    expect_input_error([&] { voctree::read_clip(clip); }, {"show.nvv", "in segments", "000000.nvv"});
    std::filesystem::remove(clip / "a.nvv");
    std::filesystem::remove(clip / "b.nvv");
    expect_input_error([&] { voctree::read_clip_header(clip); }, {"show.nvv", "a.nvv"});
}

// Each has one leaf of a metre, in a box of sixteen.
TEST_F(ClipIndexTest, TheBoxOfLeavesHoldsThoseOfSegments) {
    std::string segments;
    for (int i = 0; i < 20; ++i) {
        voctree::VOctree tree = random_tree({.node_levels = 2, .frames = 1});
        tree.box_min = glm::vec3(0);
        tree.box_size = glm::vec3(16);
        voctree::build_topology(tree, {{static_cast<uint32_t>(i % 10), 0, 0, 4}});
        const std::string name = fmt::format("{}.nvv", i);
        voctree::write_nvv(clip / name, tree);
        segments += fmt::format(R"({}{{"file": "{}", "frames": 1}})", i > 0 ? ", " : "", name);
    }
    write_index(fmt::format(R"({{"neuvv_clip": 1, "fps": 30, "segments": [{}]}})", segments));
    const voctree::ClipIndex index = voctree::read_clip_index(clip);
    const auto [low, high] = voctree::occupied_box(index);
    EXPECT_EQ(low, glm::dvec3(0));
    EXPECT_GT(high.x, 8) << "of segments in between, too";
    EXPECT_LE(high.x, 10);
    EXPECT_EQ(high.y, 1);
    for (int i = 0; i < 19; ++i) std::filesystem::remove(clip / fmt::format("{}.nvv", i));
    EXPECT_EQ(voctree::occupied_box(index).first.x, 9) << "missing ones are left out";
    std::filesystem::remove(clip / "19.nvv");
    expect_input_error([&] { voctree::occupied_box(index); }, {".nvv"});
}

TEST_F(ClipIndexTest, SegmentsAreFilesOfTheirFrames) {
    write_segment("a.nvv", 2, {0, 0, 0});
    const voctree::VOctree sound = write_segment("b.nvv", 2, {4, 1, 0});
    write_index(R"({"neuvv_clip": 2, "fps": 30, "segments": [{"file": "a.nvv", "frames": 3},
                    {"file": "inside.nvv", "frames": 2}, {"file": "b.nvv", "frames": 1, "overlap": 1}]})");
    const voctree::ClipIndex index = voctree::read_clip_index(clip);
    expect_input_error([&] { voctree::read_segment(index.segments[0]); }, {"a.nvv", "2 frames", "says 3"});
    // A segment that is the folder itself: a reader that followed it would not end.
    std::filesystem::create_directory_symlink(clip, clip / "inside.nvv");
    expect_input_error([&] { voctree::read_segment(index.segments[1]); }, {"inside.nvv"});
    EXPECT_EQ(voctree::read_segment(index.segments[2]).frames, 2u);
    EXPECT_EQ(voctree::read_clip_header(clip).frames, 6u);
    EXPECT_EQ(voctree::read_clip_header(clip).box_min, sound.box_min) << "of the segments that can be played";
}

TEST_F(ClipIndexTest, AnEmptySegmentHasNoSayInTheBox) {
    voctree::VOctree nobody = random_tree({.frames = 2});
    nobody.weights.clear();
    voctree::build_topology(nobody, {});
    nobody.box_min = glm::vec3(-100);
    voctree::write_nvv(clip / "a.nvv", nobody);
    const voctree::VOctree somebody = write_segment("b.nvv", 2, {4, 1, 0});
    write_index(R"({"neuvv_clip": 1, "fps": 30, "segments": [{"file": "a.nvv", "frames": 2},
                    {"file": "b.nvv", "frames": 2}]})");
    EXPECT_EQ(voctree::read_clip_header(clip).box_min, somebody.box_min);
    std::filesystem::remove(clip / "b.nvv");
    EXPECT_EQ(voctree::read_clip_header(clip).box_min, nobody.box_min);
}

TEST_F(ClipIndexTest, DamageIsNamed) {
    const auto expect_refused = [&](const std::string& text, const std::string& problem) {
        write_index(text);
        expect_input_error([&] { voctree::read_clip_index(clip); }, {"clip.json", problem});
    };
    expect_refused("", "");
    expect_refused("[]", "index of a segmented clip");
    expect_refused(R"({"neuvv_clip": 1, "fps": 30})", "segments");
    expect_refused(R"({"neuvv_clip": 3, "fps": 30, "segments": [{"file": "a.nvv", "frames": 2}]})", "newer neuvv");
    expect_refused(R"({"neuvv_clip": 1, "fps": 0, "segments": [{"file": "a.nvv", "frames": 2}]})", "fps");
    expect_refused(R"({"neuvv_clip": 1, "fps": 30, "segments": []})", "segments");
    expect_refused(R"({"neuvv_clip": 1, "fps": 30, "segments": [{"file": "a.nvv", "frames": 0}]})",
                   "segments[0].frames");
    expect_refused(R"({"neuvv_clip": 1, "fps": 30, "segments": [{"file": "a.nvv", "frames": -1}]})",
                   "segments[0].frames");
    expect_refused(R"({"neuvv_clip": 1, "fps": 30, "segments": [{"file": "a.nvv", "frames": 9999999},
                       {"file": "b.nvv", "frames": 2}]})",
                   "segments[1].frames");
    expect_refused(R"({"neuvv_clip": 1, "fps": 30, "segments": [{"file": "a.nvv", "frames": 2},
                       {"file": "a.nvv", "frames": 2}]})",
                   "segments[1].file");
    for (const char* overlap : {"-1", "0.5", "100000"})
        expect_refused(R"({"neuvv_clip": 2, "fps": 30, "segments": [{"file": "a.nvv", "frames": 2, "overlap": )" +
                           std::string(overlap) + "}]}",
                       "segments[0].overlap");
    for (const char* name : {"../a.nvv", "/etc/a.nvv", "sub/a.nvv", "", "..", "a.txt"})
        expect_refused(
            R"({"neuvv_clip": 1, "fps": 30, "segments": [{"file": ")" + std::string(name) + R"(", "frames": 2}]})",
            "segments[0].file");
}

TEST(SegmentsFromMiddle, TheNearestComeFirst) {
    EXPECT_TRUE(voctree::segments_from_middle(0).empty());
    EXPECT_EQ(voctree::segments_from_middle(1), (std::vector<size_t>{0}));
    EXPECT_EQ(voctree::segments_from_middle(4), (std::vector<size_t>{2, 1, 3, 0}));
    EXPECT_EQ(voctree::segments_from_middle(5), (std::vector<size_t>{2, 1, 3, 0, 4}));
}

TEST(ClipPath, EndsWithTheName) {
    EXPECT_EQ(voctree::clip_path("build/long.nvv/"), "build/long.nvv");
    EXPECT_EQ(voctree::clip_path("long.nvv/"), "long.nvv");
    for (const char* same : {"build/long.nvv", "long.nvv", "/", "", ".", "../"})
        EXPECT_EQ(voctree::clip_path(same).string(), same == std::string("../") ? ".." : same);
}

TEST(SegmentFrame, IsTheNearest) {
    const voctree::ClipIndex index{25, {{"a", 0, 4}, {"b", 4, 1}, {"c", 5, 3}}};
    const struct {
        double frame;
        uint32_t segment;
        float local;
    } cases[] = {{-2, 0, 0}, {0, 0, 0},   {2.25, 0, 2.25f}, {3, 0, 3},      {3.4, 0, 3}, {3.5, 1, 0},
                 {4, 1, 0},  {4.4, 1, 0}, {4.5, 2, 0},      {5.5, 2, 0.5f}, {7, 2, 2},   {100, 2, 2}};
    for (const auto& one : cases) {
        const voctree::SegmentFrame at = voctree::segment_frame(index, one.frame);
        EXPECT_EQ(at.segment, one.segment) << one.frame;
        EXPECT_EQ(at.frame, one.local) << one.frame;
    }
}

TEST(SegmentFrame, IsInTheOverlapUntilTheNextSegmentBegins) {
    const voctree::ClipIndex index{25, {{"a", 0, 4, 1}, {"b", 4, 1}, {"c", 5, 3, 2}}};
    const struct {
        double frame;
        uint32_t segment;
        float local;
    } cases[] = {{3, 0, 3},   {3.5, 0, 3.5f}, {3.75, 0, 3.75f}, {4, 1, 0},
                 {4.4, 1, 0}, {4.5, 2, 0},    {7, 2, 2},        {9, 2, 2}};
    for (const auto& one : cases) {
        const voctree::SegmentFrame at = voctree::segment_frame(index, one.frame);
        EXPECT_EQ(at.segment, one.segment) << one.frame;
        EXPECT_EQ(at.frame, one.local) << one.frame;
    }
}

TEST(SegmentShares, FadeOverTheFramesOfAnOverlap) {
    const voctree::ClipIndex index{25, {{"a", 0, 4, 2}, {"b", 4, 4, 1}, {"c", 8, 4}, {"d", 12, 1}}};
    const struct {
        double frame;
        uint32_t segment;
        float share;
        uint32_t other;     // segment
        float other_frame;  // −1: only one is shown
    } cases[] = {{0, 0, 1, 0, -1},
                 {3, 0, 1, 0, -1},
                 {3.25, 0, 11.0f / 12, 1, 0},
                 {4, 1, 1.0f / 3, 0, 4},
                 {4.75, 1, 1.75f / 3, 0, 4.75f},
                 {5, 1, 2.0f / 3, 0, 5},
                 {5.5, 1, 2.5f / 3, 0, 5},
                 {6, 1, 1, 0, -1},
                 {8, 2, 0.5f, 1, 4},
                 {8.75, 2, 0.875f, 1, 4},
                 {9, 2, 1, 0, -1},
                 {12, 3, 1, 0, -1}};
    for (const auto& one : cases) {
        SCOPED_TRACE(one.frame);
        const std::vector<voctree::SegmentShare> shares = voctree::segment_shares(index, one.frame);
        ASSERT_EQ(shares.size(), one.other_frame < 0 ? 1u : 2u);
        EXPECT_EQ(shares[0].at.segment, one.segment);
        EXPECT_EQ(shares[0].at.frame, voctree::segment_frame(index, one.frame).frame);
        EXPECT_FLOAT_EQ(shares[0].share, one.share);
        if (one.other_frame < 0) continue;
        EXPECT_EQ(shares[1].at.segment, one.other);
        EXPECT_EQ(shares[1].at.frame, one.other_frame);
        EXPECT_FLOAT_EQ(shares[0].share + shares[1].share, 1);
    }
    EXPECT_EQ(voctree::fade_frames({25, {{"a", 0, 4, 9}, {"b", 4, 3}}}, 0), 2u);
    EXPECT_EQ(voctree::fade_frames({25, {{"a", 0, 4, 9}}}, 0), 0u) << "there is no next one";
}

}  // namespace
}  // namespace neuvv::test
