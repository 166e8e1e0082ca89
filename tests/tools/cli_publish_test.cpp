// neuvv publish, and what plays streams, on the command line.
#include <gtest/gtest.h>

#include "support/child_process.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"
#include "training/metrics.h"

namespace neuvv {
namespace {

struct CliPublish : CliGpu {
    std::string stream = file("show.nvs");

    nlohmann::json publish(const std::string& clip, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"publish", clip,     "-o",    stream,  "--views",
                                              "3",       "--size", "64x64", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult run = run_neuvv(arguments);
        EXPECT_EQ(run.code, 0) << run.err;
        return run.code == 0 ? nlohmann::json::parse(run.out) : nlohmann::json();
    }
    media::Image frame(const std::string& clip, const char* number) {
        const ProgramResult run =
            run_neuvv({"render", clip, "-o", file("x.png"), "--frames", number, "--size", "64x64"});
        EXPECT_EQ(run.code, 0) << run.err;
        return media::read_png(file("x.png"));
    }
    media::Image on_stage(const std::string& clip, const char* time) {
        test::write_stage(file("show.gltf"), clip, "anna");
        const ProgramResult run =
            run_neuvv({"render", file("show.gltf"), "-o", file("x.png"), "--size", "64x48", "--time", time});
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
        EXPECT_GT(training::compare(on_stage(scene, time), on_stage(stream, time)).psnr, 40) << time;
    EXPECT_NE(frame(stream, "0").rgba, frame(stream, "3").rgba);
    const nlohmann::json coarse = publish(scene, {"--quality", "30"});
    EXPECT_LT(coarse.at("bytes"), 0.6 * fine.at("bytes").get<double>());
    EXPECT_GE(coarse.at("psnr_db"), 30);
    EXPECT_LT(coarse.at("psnr_db"), fine.at("psnr_db"));

    write_own_data();
    const ProgramResult eval = run_neuvv({"eval", stream, file("data"), "--samples", "1", "--json", "-"});
    ASSERT_EQ(eval.code, 0) << eval.err;
    EXPECT_GT(nlohmann::json::parse(eval.out).at("psnr"), 25) << "one of three times lies between two frames";
}

TEST_F(CliPublish, ARateIsKept) {
    const double fine = publish(scene, {"--rate", "1000"}).at("mbps");
    const nlohmann::json half = publish(scene, {"--rate", std::to_string(0.6 * fine)});
    EXPECT_LE(half.at("mbps"), 0.6 * fine);
    EXPECT_GT(half.at("mbps"), 0.3 * fine);
    EXPECT_FALSE(half.contains("psnr_db"));
    const ProgramResult least = run_neuvv({"publish", scene, "-o", stream, "--rate", "0.01"});
    EXPECT_EQ(least.code, 0) << least.err;
    EXPECT_NE(least.err.find("not 0.01"), std::string::npos) << least.err;
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
    EXPECT_GT(training::compare(on_stage(scene, "1.5"), on_stage(stream, "1.5")).psnr, 38);
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
    ASSERT_EQ(run_neuvv({"render", show, "-o", file("x.png"), "--size", "64x48", "--time", "0.5"}).code, 0);
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
             {"info", stream, "--check"}, {"render", stream, "-o", file("x.png"), "--frames", "3"}}) {
        const ProgramResult damaged = run_neuvv(call);
        EXPECT_EQ(damaged.code, 2);
        EXPECT_NE(damaged.err.find("show.nvs: frame 3: is damaged"), std::string::npos) << damaged.err;
    }
    EXPECT_EQ(run_neuvv({"render", stream, "-o", file("x.png"), "--frames", "2", "--size", "16x16"}).code, 0);
}

}  // namespace
}  // namespace neuvv
