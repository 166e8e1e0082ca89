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
    std::set<std::string> taken = {"--help", "--output"};
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

}  // namespace
}  // namespace neuvv
