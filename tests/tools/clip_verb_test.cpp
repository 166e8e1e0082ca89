// `neuvv clip`: cut and join.
#include <gtest/gtest.h>

#include "base/file_lock.h"
#include "base/output_path.h"
#include "support/random_tree.h"
#include "support/segmented_copy.h"
#include "support/temporary_folder.h"
#include "tests/tools/run_neuvv.h"
#include "training/run/claim.h"
#include "voctree/files/clip.h"
#include "voctree/files/world_frame.h"

namespace neuvv {
namespace {

struct ClipVerb : testing::Test {
    TemporaryFolder folder;
    voctree::VOctree tree = test::random_tree({.leaves = 300, .bases = 6, .frames = 6});
    std::string whole = (folder.path / "whole.nvv").string(), parts = (folder.path / "parts.nvv").string();

    void SetUp() override {
        tree.fps = 2;
        voctree::write_nvv(whole, tree);
        write_segmented_copy(tree, {2, 3, 1}, parts);
    }
    std::string file(const std::string& name) const { return (folder.path / name).string(); }
    static std::string bytes_of(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    void run(const std::vector<std::string>& words, const char* says) {
        const ProgramResult result = run_neuvv(words);
        ASSERT_EQ(result.code, 0) << result.err;
        EXPECT_NE(result.out.find(says), std::string::npos) << result.out;
        EXPECT_EQ(folder.entries(), 3u) << "nothing but the output";
    }
};

TEST_F(ClipVerb, APartOfAFileIsAFile) {
    run({"clip", "cut", whole, "-o", file("a.nvv"), "--from", "1", "--to", "2s"}, "3 frames in 1 segment");
    const voctree::VOctree read = voctree::read_nvv(file("a.nvv"));
    EXPECT_EQ(read.weights, voctree::frames_of(tree, 1, 3).weights);
    EXPECT_EQ(read.fps, 2);
}

TEST_F(ClipVerb, APartStandsWhereTheClipDoes) {
    const voctree::WorldFrame frame{{512350, 410, -5403210}, 1};
    const voctree::ChunkOfFrame chunk(frame);
    voctree::write_nvv(whole, tree, chunk.views());
    run({"clip", "cut", whole, "-o", file("a.nvv"), "--from", "1", "--to", "2s"}, "3 frames in 1 segment");
    EXPECT_EQ(voctree::read_world_frame(file("a.nvv")), frame);
    expect_refused({"clip", "join", whole, parts, "-o", file("b.nvv")}, 2, {"000000.nvv", "another origin or unit"});
    const ProgramResult info = run_neuvv({"info", whole});
    EXPECT_NE(info.out.find("capture (512350, 410, -5403210) is the clip's origin"), std::string::npos) << info.out;
}

TEST_F(ClipVerb, WholeSegmentsAreCopied) {
    run({"clip", "cut", parts, "-o", file("a.nvv"), "--from", "0:0.5"}, "5 frames in 3 segments");
    const voctree::ClipIndex index = voctree::read_clip_index(file("a.nvv"));
    ASSERT_EQ(index.segments.size(), 3u);
    EXPECT_EQ(index.segments[0].frames, 1u);
    EXPECT_EQ(voctree::read_segment(index.segments[0]).weights, voctree::frames_of(tree, 1, 1).weights);
    EXPECT_EQ(bytes_of(index.segments[1].file), bytes_of(parts + "/000002.nvv"));
    EXPECT_EQ(bytes_of(index.segments[2].file), bytes_of(parts + "/000005.nvv"));
}

// A segment whose training has not ended: its .state is there, or somebody has its claim.
TEST_F(ClipVerb, AHalfTrainedSegmentIsSaid) {
    write_text(parts + "/000002.nvv.state", "half trained");
    const ProgramResult half = run_neuvv({"clip", "cut", parts, "-o", file("a.nvv"), "--from", "2", "--to", "4"});
    ASSERT_EQ(half.code, 0) << half.err;
    EXPECT_NE(half.err.find("000002.nvv is half trained (its training was interrupted)"), std::string::npos)
        << half.err;
    const ProgramResult other = run_neuvv({"clip", "cut", parts, "-o", file("b.nvv"), "--to", "2"});
    EXPECT_EQ(other.err.find("half trained"), std::string::npos) << other.err;
    std::filesystem::remove(parts + "/000002.nvv");
    expect_refused({"clip", "cut", parts, "-o", file("c.nvv")}, 2, {"000002.nvv", "is not there", "--resume"});
    // What is not trained is no damage, but no whole clip either, unless somebody trains.
    expect_refused({"info", parts, "--check"}, 2, {"1 segments that are not trained", "--resume"});
    const auto claim = training::RunClaim::take(parts + "/000002.nvv");
    ASSERT_TRUE(claim);
    claim->report(0.4);
    const ProgramResult info = run_neuvv({"info", parts, "--check"});
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_NE(info.out.find("is not trained so far; process"), std::string::npos) << info.out;
}

TEST_F(ClipVerb, AnOverlapEndsWithThePart) {
    std::filesystem::remove_all(parts);
    write_segmented_copy(tree, {2, 3, 1}, parts, 1);
    run({"clip", "cut", parts, "-o", file("a.nvv"), "--to", "5"}, "5 frames in 2 segments");
    const voctree::ClipIndex index = voctree::read_clip_index(file("a.nvv"));
    EXPECT_EQ(index.segments[0].overlap, 1u);
    EXPECT_EQ(bytes_of(index.segments[0].file), bytes_of(parts + "/000000.nvv"));
    EXPECT_EQ(index.segments[1].overlap, 0u);
    EXPECT_EQ(voctree::read_segment(index.segments[1]).weights, voctree::frames_of(tree, 2, 3).weights);
    std::filesystem::remove_all(file("a.nvv"));
    run({"clip", "cut", parts, "-o", file("a.nvv"), "--to", "2"}, "2 frames in 1 segment");
    EXPECT_EQ(voctree::read_nvv(file("a.nvv")).frames, 2u);
}

TEST_F(ClipVerb, JoinedClipsFollowEachOther) {
    run({"clip", "join", parts, whole, "-o", file("a.nvv") + "/"}, "12 frames in 4 segments");
    const voctree::ClipIndex index = voctree::read_clip_index(file("a.nvv"));
    EXPECT_EQ(index.fps, 2);
    EXPECT_EQ(index.segments[3].first, 6u);
    EXPECT_EQ(bytes_of(index.segments[3].file), bytes_of(whole));
}

TEST_F(ClipVerb, WhatAKilledProgramLeftIsReplaced) {
    write_text(file("a.nvv.unfinished/lock"), "");
    write_text(file("a.nvv.unfinished/000000.nvv"), "half a segment");
    run({"clip", "cut", parts, "-o", file("a.nvv")}, "6 frames");
    EXPECT_EQ(voctree::read_clip_index(file("a.nvv")).frames(), 6u);
    EXPECT_FALSE(std::filesystem::exists(file("a.nvv/lock")));
    EXPECT_FALSE(std::filesystem::exists(file("a.nvv.unfinished")));
    {
        const TemporaryFolder victims;
        write_text(victims.path / "lock", "");
        write_text(victims.path / "dear", "dear");
        std::filesystem::create_directory_symlink(victims.path, file("b.nvv.unfinished"));
        expect_refused({"clip", "cut", parts, "-o", file("b.nvv")}, 2, {"b.nvv.unfinished"});
        EXPECT_EQ(read_text(victims.path / "dear"), "dear");
        std::filesystem::remove(file("b.nvv.unfinished"));
    }
    write_text(file("c.nvv.unfinished/lock"), "");
    const FileLock alive(file("c.nvv.unfinished/lock"));
    expect_refused({"clip", "cut", parts, "-o", file("c.nvv")}, 2, {"c.nvv.unfinished", "being written"});
}

// Whatever a process that was killed left beside it.
TEST_F(ClipVerb, AClipIsReplacedByAnother) {
    write_text(file("a.nvv.replaced/000000.nvv"), "old");
    for (const uint32_t frames : {5u, 2u, 4u}) {  // a folder, a file and a folder again
        const ProgramResult result =
            run_neuvv({"clip", "cut", parts, "-o", file("a.nvv"), "--to", std::to_string(frames), "--overwrite"});
        ASSERT_EQ(result.code, 0) << result.err;
        EXPECT_EQ(voctree::read_clip_index(file("a.nvv")).frames(), frames);
        EXPECT_EQ(folder.entries(), 4u) << "nothing but the output";
    }
    EXPECT_EQ(read_text(file("a.nvv.replaced/000000.nvv")), "old");
}

TEST_F(ClipVerb, WhatCannotBeIsRefused) {
    expect_refused({"clip", "cut", whole, "-o", file("a.nvv"), "--from", "4", "--to", "4"}, 2, {"--from", "6 frames"});
    expect_refused({"clip", "cut", whole, "-o", file("a.nvv"), "--to", "4s"}, 2, {"whole.nvv", "6 frames"});
    expect_refused({"clip", "cut", whole, "-o", file("a.nvv"), "--to", "soon"}, 2, {"--to", "soon"});
    expect_refused({"clip", "cut", whole, "-o", parts}, 2, {"parts.nvv", "is there already"});
    expect_refused({"clip", "cut", whole, "-o", file("a.mp4")}, 2, {"a.mp4", "no name of a clip"});
    expect_refused({"clip", "join", whole, "-o", file("a.nvv")}, 2, {"whole.nvv", "two or more"});
    std::filesystem::create_directory(file("a.nvv.unfinished"));
    expect_refused({"clip", "cut", whole, "-o", file("a.nvv")}, 2, {"a.nvv.unfinished", "is there already"});
    EXPECT_TRUE(std::filesystem::remove(file("a.nvv.unfinished"))) << "it is somebody else's";
    expect_refused({"clip", "cut", file("none.nvv"), "-o", file("a.nvv")}, 2, {"none.nvv"});
    tree.fps = 25;
    voctree::write_nvv(whole, tree);
    expect_refused({"clip", "join", parts, whole, "-o", file("a.nvv")}, 2, {"whole.nvv", "25 frames a second"});
    write_text_file(parts + "/000002.nvv", "no tree");
    expect_refused({"clip", "cut", parts, "-o", file("a.nvv")}, 2, {"000002.nvv"});
    EXPECT_EQ(folder.entries(), 2u) << "nothing is left behind";
}

}  // namespace
}  // namespace neuvv
