// neuvv publish, and what plays streams, on the command line.
#include <gtest/gtest.h>

#include "media/psnr.h"
#include "support/child_process.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

struct CliPublish : CliGpu {
    std::string stream = file("show.nvs");

    nlohmann::json publish(const std::string& clip, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"publish", "--overwrite", clip,     "-o",    stream,
                                              "--views", "3",           "--size", "64x64", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult run = run_neuvv(arguments);
        EXPECT_EQ(run.code, 0) << run.err;
        return run.code == 0 ? nlohmann::json::parse(run.out) : nlohmann::json();
    }
    media::Image frame(const std::string& clip, const char* number) {
        const ProgramResult run =
            run_neuvv({"render", "--overwrite", clip, "-o", file("x.png"), "--frames", number, "--size", "64x64"});
        EXPECT_EQ(run.code, 0) << run.err;
        return media::read_png(file("x.png"));
    }
    media::Image on_stage(const std::string& clip, const char* time) {
        test::write_stage(file("show.gltf"), clip, "anna");
        const ProgramResult run = run_neuvv(
            {"render", "--overwrite", file("show.gltf"), "-o", file("x.png"), "--size", "64x48", "--time", time});
        EXPECT_EQ(run.code, 0) << run.err;
        return media::read_png(file("x.png"));
    }
};

// The clip is seen from its own orbit; a stream's is around its box, as that of a clip in segments. So both are
// compared on a stage.
TEST_F(CliPublish, AStreamShowsWhatTheClipDoes) {
    const nlohmann::json fine = publish(scene, {"--quality", "50"});
    EXPECT_GE(fine.at("psnr_db"), 50);
    EXPECT_EQ(fine.at("frames"), 4);
    EXPECT_EQ(fine.at("bytes"), std::filesystem::file_size(stream));
    for (const char* time : {"0", "0.5", "1.5"})
        EXPECT_GT(media::psnr_db(on_stage(scene, time), on_stage(stream, time)), 40) << time;
    EXPECT_NE(frame(stream, "0").rgba, frame(stream, "3").rgba);
    const nlohmann::json coarse = publish(scene, {"--quality", "30"});
    EXPECT_LT(coarse.at("bytes"), 0.6 * fine.at("bytes").get<double>());
    EXPECT_GE(coarse.at("psnr_db"), 30);
    EXPECT_LT(coarse.at("psnr_db"), fine.at("psnr_db"));

    write_own_data();
    const ProgramResult eval =
        run_neuvv({"eval", "--overwrite", stream, file("data"), "--samples", "1", "--json", "-"});
    ASSERT_EQ(eval.code, 0) << eval.err;
    EXPECT_GT(nlohmann::json::parse(eval.out).at("psnr"), 25) << "one of three times lies between two frames";
}

TEST_F(CliPublish, ARateIsKept) {
    const double fine = publish(scene, {"--rate", "1000"}).at("mbps");
    const nlohmann::json half = publish(scene, {"--rate", std::to_string(0.6 * fine)});
    EXPECT_LE(half.at("mbps"), 0.6 * fine);
    EXPECT_GT(half.at("mbps"), 0.3 * fine);
    EXPECT_FALSE(half.contains("psnr_db"));
    EXPECT_LE(half.at("most_mbps"), 0.6 * fine);
    const ProgramResult least = run_neuvv({"publish", "--overwrite", scene, "-o", stream, "--rate", "0.01", "--json"});
    EXPECT_EQ(least.code, 0) << least.err;
    EXPECT_NE(least.err.find("--rate 0.01 is not reached: a group takes up to 0."), std::string::npos) << least.err;
    EXPECT_GT(nlohmann::json::parse(least.out).at("most_mbps"), 0.01);
}

// The index and the tables of groups count for the rate, but for no frame.
TEST_F(CliPublish, TheLargestFrameIsNoSmallerThanTheMean) {
    publish(scene, {"--quality", "30"});
    const ProgramResult info = run_neuvv({"info", stream});
    const size_t line = info.out.find("\nframes ");
    ASSERT_NE(line, std::string::npos) << info.out;
    double mean = 0, most = 0;
    ASSERT_EQ(std::sscanf(info.out.c_str() + line, "\nframes %lf KB without them, %lf KB at most", &mean, &most), 2)
        << info.out;
    EXPECT_GT(mean, 0);
    EXPECT_LE(mean, most);
    double parts = 0;
    for (size_t at = info.out.find('\n', line + 1); at + 1 < info.out.size(); at = info.out.find('\n', at + 1)) {
        double part = 0;
        EXPECT_EQ(std::sscanf(info.out.c_str() + at, "\n%*s %lf KB a frame", &part), 1) << info.out;
        parts += part;
    }
    EXPECT_NEAR(parts, mean, 0.3) << "each is rounded to 0.1";
}

TEST_F(CliPublish, SegmentsBecomeOneStream) {
    const std::string parts = file("parts.nvv");
    write_segmented_copy(tree, {1, 3}, parts, 1);
    publish(parts, {"--quality", "45", "--group", "1"});
    const ProgramResult info = run_neuvv({"info", stream, "--json", "--check"});
    ASSERT_EQ(info.code, 0) << info.err;
    const auto json = nlohmann::json::parse(info.out);
    EXPECT_EQ(json.at("frames"), 4);
    EXPECT_EQ(json.at("groups"), 3) << "one frame; two of three, as one second has; one";
    EXPECT_EQ(json.at("checked"), true);
    EXPECT_GT(media::psnr_db(on_stage(scene, "1.5"), on_stage(stream, "1.5")), 38);
}

// A painted performer against streams of it: one of the stage, and one of its clip alone.
struct CliPublishPainted : CliPublish {
    std::string show = file("painted.gltf"), layer = file("look.nvpaint");

    void edit(const std::vector<std::string>& arguments) {
        const ProgramResult run = run_neuvv(arguments);
        EXPECT_EQ(run.code, 0) << run.err;
    }
    void add_painted(const std::string& clip, const char* name = "anna") {
        edit({"stage", "add", show, clip, "--name", name});
        edit({"paint", "region", show, layer, "--node", name, "--colour", "#ff2000", "--box", "-9,-9,-9,9,9,9",
              "--alpha", "0.8", "--frames", "0:2"});
        edit({"paint", "erase", show, layer, "--node", name, "--box", "-9,-9,-9,0.2,9,9", "--frames", "1:3"});
    }
    media::Image rendered(const std::string& stage, const char* time) {
        edit({"render", "--overwrite", stage, "-o", file("x.png"), "--size", "64x48", "--time", time});
        return media::read_png(file("x.png"));
    }
    // At three frames with different paint.
    void expect_painted_stream(const std::string& clip) {
        const std::string bare = file("bare.gltf");
        test::write_stage(bare, clip, "anna");
        for (const char* time : {"0", "0.5", "1.5"}) {
            const media::Image truth = rendered(show, time);
            EXPECT_LT(media::psnr_db(truth, rendered(bare, time)), 30) << "paint is seen at " << time;
            EXPECT_GT(media::psnr_db(truth, on_stage(stream, time)), 40) << time;
        }
    }
};

TEST_F(CliPublishPainted, AStreamOfAStageHasThePaint) {
    edit({"stage", "new", show});
    add_painted(scene);
    edit({"stage", "paint", show, "anna", "--layer", "0", "--blend", "tint"});
    edit({"paint", "region", show, file("over.nvpaint"), "--colour", "#2040ff", "--box", "-9,0.5,-9,9,9,9"});
    edit({"stage", "paint", show, "anna", "--layer", "1", "--opacity", "0.7"});
    const nlohmann::json both = publish(show, {"--quality", "50"});
    EXPECT_GE(both.at("psnr_db"), 50) << "against the painted clip";
    EXPECT_EQ(both.at("paint_layers"), 2);
    EXPECT_EQ(both.at("frames"), 4);
    expect_painted_stream(scene);

    edit({"stage", "paint", show, "anna", "--layer", "1", "--visible", "off"});
    EXPECT_LT(media::psnr_db(rendered(show, "0"), on_stage(stream, "0")), 35) << "the stream keeps the layer";
    EXPECT_EQ(publish(show, {"--rate", "1000"}).at("paint_layers"), 1);
    expect_painted_stream(scene);
}

TEST_F(CliPublishPainted, SegmentsHaveThePaintOfTheirFiles) {
    const std::string parts = file("parts.nvv");
    write_segmented_copy(tree, {1, 3}, parts, 1);
    write_text(file("parts.m4a"), "sound");
    edit({"stage", "new", show});
    add_painted(parts);
    publish(show, {"--quality", "50"});
    EXPECT_EQ(read_text(file("show.m4a")), "sound") << "that of the clip";
    std::filesystem::remove(file("show.m4a"));
    expect_painted_stream(parts);
    write_text(layer + "/000000.nvpaint", "no paint");
    expect_refused({"publish", show, "-o", file("y.nvs"), "--rate", "9"}, 2, {"000000.nvpaint"});
    EXPECT_FALSE(std::filesystem::exists(file("y.nvs")));
    std::filesystem::remove_all(layer);
    expect_refused({"publish", show, "-o", file("y.nvs"), "--rate", "9"}, 2, {"look.nvpaint", "no such folder"});
}

TEST_F(CliPublishPainted, OneOfSeveralPerformersIsNamed) {
    edit({"stage", "new", show});
    expect_refused({"publish", show, "-o", stream}, 2, {"--performer", "has 0 performers", "neuvv stage add"});
    add_painted(scene);
    edit({"stage", "add", show, scene, "--name", "ben", "--at", "1,0,0"});
    expect_refused({"publish", show, "-o", stream}, 2, {"--performer", "2 performers", "\"anna\"", "\"ben\""});
    expect_refused({"publish", show, "--performer", "carl", "-o", stream}, 2, {"carl"});
    expect_refused({"publish", scene, "--performer", "anna", "-o", stream}, 2,
                   {"--performer", "anna", "is for stages"});
    EXPECT_FALSE(publish(show, {"--performer", "ben", "--rate", "1000"}).contains("paint_layers"));
    EXPECT_GT(media::psnr_db(on_stage(scene, "0.5"), on_stage(stream, "0.5")), 40) << "neither paint nor place";
    EXPECT_EQ(publish(show, {"--performer", "anna", "--rate", "1000"}).at("paint_layers"), 1);
    EXPECT_LT(media::psnr_db(on_stage(scene, "0.5"), on_stage(stream, "0.5")), 24);
    write_text(layer, "no paint");
    expect_refused({"publish", show, "--performer", "anna", "-o", file("y.nvs")}, 2, {"look.nvpaint"});
}

TEST_F(CliPublishPainted, WhatIsErasedInAllFramesIsAnEmptyStream) {
    edit({"stage", "new", show});
    edit({"stage", "add", show, scene, "--name", "anna"});
    edit({"paint", "erase", show, layer, "--box", "-9,-9,-9,9,9,9"});
    publish(show, {});
    EXPECT_EQ(on_stage(stream, "0").rgba, rendered(show, "0").rgba);
    EXPECT_NE(on_stage(stream, "0").rgba, on_stage(scene, "0").rgba);
}

TEST_F(CliPublish, AStagePlaysFromAServer) {
    publish(scene, {"--quality", "45"});
    const media::Image truth = on_stage(stream, "0.5");
    const std::string log = file("serve.log");
    test::ChildProcess server({NEUVV_SOURCE_DIR "/tools/serve", folder.path.string(), "--port", "0"}, log);
    std::string address;
    ASSERT_TRUE(server.until([&] {
        const std::string said = read_text(log);
        const size_t begin = said.find("http://"), end = said.find('\n');
        if (begin != std::string::npos && end != std::string::npos) address = said.substr(begin, end - begin);
        return !address.empty();
    })) << read_text(log);
    address += "show.nvs";
    const std::string show = file("net.gltf");
    ASSERT_EQ(run_neuvv({"stage", "new", show}).code, 0);
    const ProgramResult added = run_neuvv({"stage", "add", show, address, "--name", "anna", "--time", "loop"});
    ASSERT_EQ(added.code, 0) << added.err;
    ASSERT_EQ(run_neuvv({"render", "--overwrite", show, "-o", file("x.png"), "--size", "64x48", "--time", "0.5"}).code,
              0);
    EXPECT_EQ(media::read_png(file("x.png")).rgba, truth.rgba);
    const ProgramResult info = run_neuvv({"stage", "info", show});
    EXPECT_NE(info.out.find(address), std::string::npos) << info.out << info.err;
    server.send(SIGKILL);
    server.wait();
    EXPECT_EQ(run_neuvv({"stage", "set", show, "anna", "--opacity", "0.5"}).code, 0) << "edits do not need the server";
    expect_refused({"render", show, "-o", file("x.png"), "--time", "0.5"}, 2,
                   {"net.gltf", "show.nvs", "cannot be read"});
}

TEST_F(CliPublish, WrongUseIsRefused) {
    publish(scene, {"--quality", "40"});
    expect_refused({"publish", stream, "-o", file("y.nvs")}, 2, {"show.nvs", "is a stream"});
    expect_refused({"publish", scene, "-o", file("y.nvv")}, 2, {"y.nvv", ".nvs"});
    expect_refused({"publish", scene, "-o", file("y.nvs"), "--quality", "60", "--rate", "3"}, 2, {"--quality"});
    expect_refused({"publish", file("none.nvv"), "-o", file("y.nvs")}, 2, {"none.nvv"});
    expect_refused({"convert", stream, "-o", file("y.nvv")}, 2, {"show.nvs", "is a stream"});
    expect_refused({"clip", "cut", stream, "-o", file("y.nvv"), "--to", "2"}, 2, {"show.nvs", "is a stream"});
    expect_refused({"clip", "join", scene, stream, "-o", file("y.nvv")}, 2, {"show.nvs", "is a stream"});
    expect_refused({"paint", "erase", stream, file("l.nvpaint"), "--sphere", "0,0,0,1"}, 2, {"show.nvs", "stream"});
    std::string bytes = read_text(stream);
    bytes[bytes.size() - 3] = static_cast<char>(bytes[bytes.size() - 3] ^ 1);
    write_text(stream, bytes);
    for (const std::vector<std::string>& call : std::vector<std::vector<std::string>>{
             {"info", stream, "--check"}, {"render", "--overwrite", stream, "-o", file("x.png"), "--frames", "3"}}) {
        const ProgramResult damaged = run_neuvv(call);
        EXPECT_EQ(damaged.code, 2);
        EXPECT_NE(damaged.err.find("show.nvs: frame 3: is damaged"), std::string::npos) << damaged.err;
    }
    EXPECT_EQ(
        run_neuvv({"render", "--overwrite", stream, "-o", file("x.png"), "--frames", "2", "--size", "16x16"}).code, 0);
}

}  // namespace
}  // namespace neuvv
