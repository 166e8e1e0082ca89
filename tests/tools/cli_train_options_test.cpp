// Every option of `neuvv train`, in the program as its user runs it.
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "support/wav_file.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

using Words = std::vector<std::string>;

TEST_F(CliGpu, EveryOptionOfTrainIsTaken) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    test::write_wav(file("tone.wav"), std::vector<int16_t>(8000, 100), 1, 8000);
    const Words small = {"--resolution", "32", "--bases", "2", "--hh-degree", "1"};
    const std::vector<std::pair<std::string, Words>> runs = {
        {"one.nvv", {"--steps",        "3",           "--max-leaves",    "100000",        "--max-memory",  "20",
                     "--seed",         "5",           "--image-memory",  "0.5",           "--format",      "nerf",
                     "--preview",      file("p.png"), "--metrics",       file("m.jsonl"), "--lambda-grad", "0.2",
                     "--lambda-point", "0.1",         "--lambda-smooth", "0.001",         "--refine",      "colour",
                     "--leave-out",    "rays,bound",  "--audio",         file("tone.wav")}},
        {"one.nvv", {"--steps", "4", "--resume"}},
        {"psi.nvv", {"--steps", "2", "--init", "psi", "--psi-steps", "1", "--uniform", "--holdout", "0"}},
        {"brief.nvv", {"--minutes", "0.01", "--init", "psi", "--psi-minutes", "0.01", "--max-memory", "0.1"}},
        {"parts.nvv", {"--steps", "4", "--segment", "2", "--plan"}},
        {"parts.nvv", {"--steps", "4", "--resume"}},
        {"parts.nvv", {"--steps", "2", "--from", "0", "--to", "1", "--overwrite"}},
    };
    std::set<std::string> taken = {"--help", "--output", "--background"};  // the last one: see below
    for (const auto& [output, words] : runs) {
        Words all = {"train", file("data"), "-o", file(output.c_str())};
        all.insert(all.end(), small.begin(), small.end());
        all.insert(all.end(), words.begin(), words.end());
        const ProgramResult result = run_neuvv(all);
        EXPECT_EQ(result.code, 0) << output << ": " << result.err;
        taken.insert(all.begin(), all.end());
    }
    for (const char* made : {"one.nvv", "one.m4a", "p.png", "m.jsonl", "psi.nvv", "brief.nvv", "parts.nvv/clip.json"})
        EXPECT_TRUE(std::filesystem::exists(file(made))) << made;
    EXPECT_LE(std::filesystem::file_size(file("brief.nvv")), 100'000u);
    // A documented option that no run above has is missing there.
    const std::string help = run_neuvv({"train", "--help"}).out;
    const std::regex option("\n +(?:-[a-z],)?(--[a-z-]+)");
    for (std::sregex_iterator match(help.begin(), help.end(), option), end; match != end; ++match)
        EXPECT_TRUE(taken.contains((*match)[1])) << (*match)[1];
    EXPECT_GT(taken.size(), 50u);
}

TEST_F(CliGpu, TrainLearnsTheBackground) {
    const std::string performer = NEUVV_SOURCE_DIR "/tools/performer/performer.glb";
    const auto capture = [&](const char* name, const char* background) {
        const ProgramResult result = run_neuvv({"capture", performer, "-o", file(name), "--cameras", "8", "--frames",
                                                "2", "--size", "64x64", "--background", background});
        ASSERT_EQ(result.code, 0) << result.err;
    };
    const auto train = [&](const char* data, Words more = {}) {
        Words words = {"train", file(data), "-o", file("show.nvv"), "--background",
                       "learn", "--steps",  "12", "--resolution",   "32"};
        words.insert(words.end(), more.begin(), more.end());
        return run_neuvv(words);
    };
    capture("cut", "clear");
    const ProgramResult cut = train("cut");
    EXPECT_EQ(cut.code, 2);
    EXPECT_NE(cut.err.find("show nothing outside the mattes"), std::string::npos) << cut.err;
    EXPECT_FALSE(std::filesystem::exists(file("show.nvv"))) << "before the performer is trained";

    capture("room", "checker");
    const ProgramResult refused = train("room", {"--refine", "auto"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("--background"), std::string::npos) << refused.err;
    const ProgramResult both = train("room", {"--overwrite"});
    ASSERT_EQ(both.code, 0) << both.err;
    EXPECT_EQ(voctree::read_nvv(file("show.nvv")).frames, 2u);
    const voctree::VOctree room = voctree::read_nvv(file("show.background.nvv"));
    EXPECT_EQ(room.frames, 1u);
    EXPECT_GT(room.box_size.x, 4 * voctree::read_nvv(file("show.nvv")).box_size.x);
    std::filesystem::remove(file("show.nvv"));
    std::filesystem::remove(file("show.nvv.state"));
    const ProgramResult there = train("room");
    EXPECT_EQ(there.code, 2);
    EXPECT_NE(there.err.find("show.background.nvv"), std::string::npos) << there.err;
    EXPECT_FALSE(std::filesystem::exists(file("show.nvv"))) << "and that is said first";

    // Without mattes, there is nothing but the room: the plates are the images.
    std::filesystem::create_directories(file("empty"));
    const nlohmann::json captured = nlohmann::json::parse(read_text(file("room/transforms_train.json")));
    nlohmann::json frames = captured;
    frames["frames"].clear();
    for (nlohmann::json frame : captured["frames"]) {
        if (frame["time"] != 0) continue;
        const std::filesystem::path plate = frame["background_path"].get<std::string>();
        std::filesystem::copy_file(folder.path / "room" / plate, folder.path / "empty" / plate.filename());
        frame["file_path"] = plate.filename().string();
        frame.erase("background_path");
        frames["frames"].push_back(frame);
    }
    write_text(file("empty/transforms_train.json"), frames.dump());
    write_text(file("empty/transforms_test.json"), frames.dump());
    const ProgramResult alone = train("empty", {"--overwrite"});
    ASSERT_EQ(alone.code, 0) << alone.err;
    EXPECT_NE(alone.err.find("whole images are learnt"), std::string::npos) << alone.err;
    EXPECT_EQ(voctree::read_nvv(file("show.nvv")).frames, 1u);
    const ProgramResult measured = run_neuvv({"eval", file("show.nvv"), file("empty"), "--json", "-"});
    ASSERT_EQ(measured.code, 0) << measured.err;
    EXPECT_NE(measured.err.find("all of each is compared"), std::string::npos) << measured.err;
    EXPECT_GT(nlohmann::json::parse(measured.out)["psnr"].get<double>(), 12);
}

}  // namespace
}  // namespace neuvv
