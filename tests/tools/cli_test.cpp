// The command line without a GPU: help, exit codes, one-line errors, info.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/random_tree.h"
#include "tests/tools/run_neuvv.h"
#include "voctree/nvv.h"

namespace neuvv {
namespace {

struct Cli : testing::Test {
    TemporaryFolder folder;
    std::string scene = (folder.path / "scene.nvv").string();
    voctree::VOctree tree = test::random_tree({.leaves = 100, .bases = 3, .hh_degree = 2, .frames = 7});

    void SetUp() override { voctree::write_nvv(scene, tree); }
    std::string file(const char* name) const { return (folder.path / name).string(); }
};

TEST_F(Cli, EveryVerbHelpsWithExamples) {
    const std::string overview = run_neuvv({"--help"}).out;
    for (const char* verb : {"devices", "info", "capture", "dataset", "matte", "train", "eval", "render", "convert",
                             "publish", "export", "clip", "stage", "paint", "skeleton", "cluster"}) {
        EXPECT_NE(overview.find(verb), std::string::npos) << verb;
        const ProgramResult result = run_neuvv({verb, "--help"});
        EXPECT_EQ(result.code, 0) << verb;
        const size_t examples = result.out.find("Examples");
        ASSERT_NE(examples, std::string::npos) << verb;
        EXPECT_NE(result.out.find(std::string("neuvv ") + verb, examples), std::string::npos) << verb;
        EXPECT_EQ(result.err, "") << verb;
    }
}

TEST_F(Cli, EvalHelpDefinesTheMetrics) {
    const std::string help = run_neuvv({"eval", "--help"}).out;
    for (const char* word : {"PSNR", "SSIM", "MAE", "FLIP", "over white", "11x11", "sRGB"})
        EXPECT_NE(help.find(word), std::string::npos) << word;
}

// The job script, without Slurm: tests/slurm has the real one.
TEST_F(Cli, AClusterIsGivenAScript) {
    const std::string show = file("show.nvv");
    ASSERT_EQ(run_neuvv({"cluster", "sbatch", "--dry-run", "--", "info", scene}).code, 2);
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", "data", "-o", show}, 2, {"--segment"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", "data", "--segment", "2"}, 2, {"--output"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", file("no data"), "-o", show, "--segment", "2",
                    "--steps", "9"},
                   2, {"no data", "is no data set"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", "data", "-o", show, "--segment", "2"}, 2,
                   {"has no budget", "--minutes"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", "data", "-o", show, "--segment", "2", "--steps",
                    "9", "--metrics", "log.jsonl"},
                   2, {"--metrics", "one process"});
    expect_refused(
        {"cluster", "sbatch", "--dry-run", "--", "train", "data", "-o", show, "--resume", "--steps", "9", "--plan"}, 2,
        {"--plan", "of itself"});
    std::filesystem::create_directory(show);
    const ProgramResult made =
        run_neuvv({"cluster", "sbatch", "--dry-run", "--tasks", "3", "--sbatch=--gres=gpu:1 --time=1:00:00", "--",
                   "train", "it's data", "-o", show, "--resume", "--minutes", "5"});
    ASSERT_EQ(made.code, 0) << made.err;
    const std::string script = read_text(show + "/job.sh");
    for (const char* part : {"#SBATCH --array=0-2\n", "#SBATCH --gres=gpu:1 --time=1:00:00\n", "#SBATCH --requeue\n",
                             "'train' 'it'\\''s data' '-o'", "'--resume' '--minutes' '5' &"})
        EXPECT_NE(script.find(part), std::string::npos) << part << " not in: " << script;
    EXPECT_EQ(std::system(("sh -n " + shell_quoted(show + "/job.sh")).c_str()), 0);

    expect_refused({"cluster", "sbatch", "--dry-run", "--", "render", show, "-o", file("one.png")}, 2,
                   {"single image"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "render", show, "-o", file("o.mp4"), "--part", "1/2"}, 2,
                   {"--part"});
    // The render is checked before.
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "render", file("none.nvv"), "-o", file("o.mp4")}, 2,
                   {"none.nvv"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--tasks", "9999", "--", "render", scene, "-o", file("o.mp4")}, 2,
                   {"9999 parts are too many"});
    EXPECT_FALSE(std::filesystem::exists(file("o.mp4") + ".parts"));
    const ProgramResult checked =
        run_neuvv({"cluster", "sbatch", "--dry-run", "--tasks", "3", "--", "render", scene, "-o", file("o.mp4")});
    ASSERT_EQ(checked.code, 0) << checked.err;
    EXPECT_NE(checked.out.find(" images of "), std::string::npos) << checked.out;
    const std::string render = file("o.mp4") + ".parts/job.sh";
    EXPECT_NE(read_text(render).find("'--resume' --part \"$((SLURM_ARRAY_TASK_ID + 1))/3\" &"), std::string::npos)
        << read_text(render);
    EXPECT_EQ(std::system(("sh -n " + shell_quoted(render)).c_str()), 0);
}

TEST_F(Cli, WrongUseIsBadInput) {
    expect_refused({}, 2, {"--help"});
    expect_refused({"sing"}, 2, {"sing", "--help"});
    expect_refused({"info"}, 2, {"file", "neuvv info --help"});
    expect_refused({"info", scene, "--no-such-option"}, 2, {"--no-such-option", "neuvv info --help"});
    expect_refused({"eval", scene, file("data"), "--split", "both"}, 2, {"both", "neuvv eval --help"});
    expect_refused({"render", scene}, 2, {"--output"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--fps", "nan"}, 2, {"--fps"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--fps", "0"}, 2, {"--fps"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--depth", "--alpha"}, 2, {"--depth", "--alpha"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--level", "--cost"}, 2, {"--level", "--cost"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--level", "--direct"}, 2, {"--level", "--direct"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--cost-max", "9"}, 2, {"--cost-max", "--cost"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--orbit", "--camera", "c.json"}, 2, {"--orbit", "--camera"});
}

TEST_F(Cli, OnlyPartsOfTheTrainingCanBeLeftOut) {
    for (const char* names : {"colour", "merge,colour", "merge,,bound", "merge,"})
        expect_refused({"train", file("data"), "-o", file("x.nvv"), "--leave-out", names}, 2,
                       {"--leave-out", names, "divide, merge, revive, bound, rays"});
}

TEST_F(Cli, NaNIsNoNumberOfAnything) {
    for (const char* option : {"--minutes", "--max-memory", "--image-memory", "--psi-minutes", "--lambda-grad",
                               "--lambda-point", "--lambda-smooth", "--seed"})
        expect_refused({"train", file("data"), "-o", file("x.nvv"), option, "nan"}, 2, {option});
    expect_refused({"matte", file("data"), "--threshold", "nan"}, 2, {"--threshold"});
}

TEST_F(Cli, RenderRefusesWhatItCannotDoBeforeItStarts) {
    expect_refused({"render", scene, "-o", file("x.gif")}, 2, {"x.gif", "out.mp4"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--size", "big"}, 2, {"--size", "big"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--frames", "0:9"}, 2, {"--frames", "0:9", "0:6"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--background", "clear"}, 2, {"transparency", "%04d"});
    expect_refused({"render", scene, "-o", file("x.png")}, 2, {"x.png", "105 images", "%04d"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--camera", file("none.json")}, 2, {"none.json"});
    expect_refused({"render", file("none.nvv"), "-o", file("x.mp4")}, 2, {"none.nvv"});
    EXPECT_EQ(folder.entries(), 1u) << "nothing was written";
}

TEST_F(Cli, APlannedRenderSaysWhatItWouldBe) {
    const ProgramResult planned =
        run_neuvv({"render", scene, "-o", file("turn.mp4"), "--size", "101x50", "--plan", "--json"});
    ASSERT_EQ(planned.code, 0) << planned.err;
    const nlohmann::json plan = nlohmann::json::parse(planned.out);
    EXPECT_EQ(plan["width"], 102) << "the sides of a video are even";
    EXPECT_EQ(plan["height"], 50);
    EXPECT_GT(plan["images"], 1);
    EXPECT_EQ(plan["rendered"], 0);
    EXPECT_FALSE(std::filesystem::exists(file("turn.mp4")));
    const ProgramResult numbered = run_neuvv({"render", scene, "-o", file("o_%04d.png"), "--size", "101x51", "--plan"});
    ASSERT_EQ(numbered.code, 0) << numbered.err;
    EXPECT_NE(numbered.out.find(" images of 101x51"), std::string::npos) << numbered.out;
    EXPECT_EQ(numbered.out.find("rendered"), std::string::npos) << numbered.out;
}

TEST_F(Cli, EvalNamesTheMissingDataSet) {
    expect_refused({"eval", scene, file("data")}, 2, {"data", "transforms_train.json"});
}

TEST_F(Cli, InfoSaysWhatTheFileHolds) {
    const ProgramResult result = run_neuvv({"info", scene, "--json", "--check"});
    ASSERT_EQ(result.code, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json.at("file"), scene);
    EXPECT_EQ(json.at("version"), 3);
    EXPECT_EQ(json.at("bytes"), std::filesystem::file_size(scene));
    EXPECT_EQ(json.at("leaves"), tree.leaf_count);
    EXPECT_EQ(json.at("nodes"), tree.nodes.size());
    EXPECT_EQ(json.at("node_levels"), 2);
    EXPECT_EQ(json.at("cells_per_side"), 16);
    EXPECT_EQ(json.at("bases"), 3);
    EXPECT_EQ(json.at("hh_degree"), 2);
    EXPECT_EQ(json.at("weights_per_leaf"), 2 * 3 + 3 * 14);
    EXPECT_EQ(json.at("frames"), 7);
    EXPECT_EQ(json.at("fps"), 25);
    EXPECT_EQ(json.at("box").at("max").at(1), 1.25);
    EXPECT_EQ(json.at("chunks").size(), 9u);
    EXPECT_EQ(json.at("chunks").at(0).at("name"), "HEAD");
    EXPECT_EQ(json.at("checked"), true);

    const ProgramResult text = run_neuvv({"info", scene});
    EXPECT_EQ(text.code, 0);
    for (const char* part : {"7 frames", "25 fps", "C = 3", "n_max = 2", "WHHC"})
        EXPECT_NE(text.out.find(part), std::string::npos) << part;
}

TEST_F(Cli, DamagedFilesAreBadInput) {
    const std::string whole = read_text(scene);
    write_text(file("cut.nvv"), whole.substr(0, whole.size() / 2));
    write_text(file("foreign.nvv"), "PK\x03\x04 not one of ours");
    write_text(file("empty.nvv"), "");
    std::string flipped = whole;
    flipped[whole.size() - 100] ^= 1;  // in the last weights, which only --check reads
    write_text(file("flipped.nvv"), flipped);

    for (const char* name : {"cut.nvv", "foreign.nvv", "empty.nvv", "missing.nvv"})
        for (const char* verb : {"info", "render"}) {
            std::vector<std::string> arguments = {verb, file(name)};
            if (verb == std::string("render")) arguments.insert(arguments.end(), {"-o", file("x.mp4")});
            expect_refused(arguments, 2, {name});
        }
    expect_refused({"info", folder.path.string()}, 2, {folder.path.string()});
    expect_refused({"info", file("flipped.nvv"), "--check"}, 2, {"flipped.nvv", "checksum"});
    EXPECT_EQ(run_neuvv({"info", file("flipped.nvv")}).code, 0);
}

}  // namespace
}  // namespace neuvv
