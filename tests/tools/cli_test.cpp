// The command line without a GPU: help, exit codes, one-line errors, info.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/text.h"
#include "support/random_tree.h"
#include "tests/tools/run_neuvv.h"
#include "voctree/files/nvv.h"

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

// A disk of logs that is full, and streams that whoever started the program has closed.
TEST_F(Cli, WhatNobodyCanReadEndsNothing) {
    for (const char* redirected : {"2>/dev/full", "2>&-", "<&- 2>&-"}) {
        const std::string show = file("show.gltf");
        std::filesystem::remove(show);
        EXPECT_EQ(run_neuvv({"stage", "new", show}, "", redirected).code, 0) << redirected;
        EXPECT_EQ(run_neuvv({"info", file("none.nvv")}, "", redirected).code, 2) << redirected;
        EXPECT_EQ(run_neuvv({"train", file("none"), "-o", file("x.nvv")}, "", redirected).code, 2) << redirected;
        EXPECT_EQ(run_neuvv({"no verb"}, "", redirected).code, 2) << redirected;
        EXPECT_EQ(read_text(show).front(), '{') << "nothing was printed into the file";
        EXPECT_EQ(run_neuvv({"info", show}).code, 0) << redirected;
    }
    for (const char* redirected : {">/dev/full", ">&-", "<&- >&- 2>&-"})
        EXPECT_EQ(run_neuvv({"info", scene}, "", redirected).code, 1) << redirected << ": its results are lost";
}

TEST_F(Cli, EvalHelpDefinesTheMetrics) {
    const std::string help = run_neuvv({"eval", "--help"}).out;
    for (const char* word : {"PSNR", "SSIM", "MAE", "FLIP", "over white", "11x11", "sRGB"})
        EXPECT_NE(help.find(word), std::string::npos) << word;
}

TEST_F(Cli, ExportHelpSaysHowAllPerformersAreWritten) {
    const std::string help = run_neuvv({"export", "--help"}).out;
    EXPECT_LT(help.find("{performer}"), help.find("\n  --performer")) << "with --output";
}

// The job script, without Slurm: tests/slurm has the real one.
TEST_F(Cli, AClusterIsGivenAScript) {
    const std::string show = file("show.nvv");
    ASSERT_EQ(run_neuvv({"cluster", "sbatch", "--dry-run", "--", "info", scene}).code, 2);
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", "data", "-o", show}, 2, {"--segment"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", "data", "--segment", "2"}, 2, {"--output"});
    expect_refused({"cluster", "sbatch", "--dry-run", "--", "train", file("no data"), "-o", show, "--segment", "2",
                    "--steps", "9"},
                   2, {"no data", "there is no such folder"});
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

TEST_F(Cli, HelpIsFoundAndFitsATerminal) {
    const ProgramResult alone = run_neuvv({});
    EXPECT_EQ(alone.code, 0) << alone.err;
    EXPECT_EQ(alone.out, run_neuvv({"--help"}).out);
    EXPECT_LT(alone.out.find("Train and measure:"), alone.out.find("\n  eval ")) << "verbs stand by task";
    EXPECT_EQ(run_neuvv({"help", "stage", "set"}).out, run_neuvv({"stage", "set", "--help"}).out);
    std::istringstream overview(alone.out);
    std::vector<std::string> verbs{"stage set", "paint project", "skeleton follow", "cluster sbatch"};
    for (std::string line; std::getline(overview, line);)
        if (line.starts_with("  ") && line.size() > 14 && std::islower(line[2]) && line[13] == ' ' && line[14] != ' ')
            verbs.push_back(line.substr(2, line.find(' ', 2) - 2));
    std::erase(verbs, "neuvv");  // an example
    EXPECT_GT(verbs.size(), 20u);
    for (const std::string& verb : verbs) {
        std::vector<std::string> words{"help"};
        for (const std::string& word : split(verb, ' ')) words.push_back(word);
        const ProgramResult help = run_neuvv(words);
        EXPECT_EQ(help.code, 0) << help.err;
        std::istringstream lines(help.out);
        for (std::string line; std::getline(lines, line);)
            EXPECT_LE(std::ranges::count_if(line, [](char c) { return (c & 0xc0) != 0x80; }), 100)
                << verb << ": " << line;
    }
}

TEST_F(Cli, NearMissesAreGuessed) {
    expect_refused({"trian"}, 2, {"there is no `neuvv trian`", "did you mean `train`?"});
    expect_refused({"stage", "lihgt"}, 2, {"did you mean `light`?", "`neuvv stage --help`"});
    expect_refused({"train", "--minuts", "5"}, 2, {"has no option --minuts", "did you mean `--minutes`?"});
    expect_refused({"render", scene, "-o", file("x.png"), "--frame=0"}, 2, {"--frame=0", "`--frames`"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--overwrit"}, 2, {"`--overwrite`"});
    expect_refused({"help", "rendre"}, 2, {"did you mean `render`?"});
    expect_refused({"info", scene, "second"}, 2, {"no further \"second\""});
}

TEST_F(Cli, VersionNamesTheCommit) {
    const std::string version = run_neuvv({"--version"}).out;
    EXPECT_EQ(version.rfind("neuvv 0.", 0), 0u) << version;
    if (std::filesystem::exists(NEUVV_SOURCE_DIR "/.git")) {
        EXPECT_NE(version.find(", commit "), std::string::npos) << version;
    }
}

// An empty value is a script's variable that is not set, and no default.
TEST_F(Cli, AnOptionHasAValue) {
    for (const char* option : {"--time", "--frames", "--camera", "--size"}) {
        expect_refused({"render", scene, std::string(option) + "=", "-o", file("x.mp4")}, 2, {option, "has no value"});
        expect_refused({"render", scene, "-o", file("x.mp4"), option, ""}, 2, {option, "has no value"});
    }
    expect_refused({"info", ""}, 2, {"file", "has no value"});
    ASSERT_EQ(run_neuvv({"stage", "new", file("s.gltf")}).code, 0);
    EXPECT_EQ(run_neuvv({"stage", "set", file("s.gltf"), "--environment="}).code, 0) << "which takes it away";
}

TEST_F(Cli, WhatIsNotThereIsSaid) {
    expect_refused({"dataset", file("none")}, 2, {"none", "there is no such folder; check the path"});
    expect_refused({"eval", scene, file("none")}, 2, {"none", "there is no such folder; check the path"});
    expect_refused({"train", file("none"), "-o", file("x.nvv")}, 2, {"none", "there is no such folder"});
    expect_refused({"eval", scene, scene}, 2, {"is a file, not the folder of a data set"});
    expect_refused({"view", file("none.nvv")}, 2, {"none.nvv", "there is no such file", "check the path"});
    const std::string image = file("x.mp4"), camera = file("none.json");
    expect_refused({"render", scene, "-o", image, "--camera", camera}, 2, {"none.json: cannot open", "check the path"});
    const std::string show = file("s.gltf");
    ASSERT_EQ(run_neuvv({"stage", "new", show}).code, 0);
    ASSERT_EQ(run_neuvv({"stage", "add", show, scene, "--name", "anna"}).code, 0);
    expect_refused({"stage", "set", show, "anna", "--sound", file("none.wav")}, 2,
                   {"none.wav: cannot open", "check the path"});
    expect_refused({"xr", file("none.gltf")}, 2, {"none.gltf", "there is no such file"});
    expect_refused({"view", scene, "--report", scene}, 2, {"--report", ".json"});
    EXPECT_EQ(folder.entries(), 2u);
}

TEST_F(Cli, InfoNamesTheVerbThatTellsMore) {
    const std::string layer = file("red.nvpaint"), images = file("images");
    ASSERT_EQ(run_neuvv({"paint", "region", scene, layer, "--box", "-9,-9,-9,9,9,9", "--hue", "9"}).code, 0);
    expect_refused({"info", layer}, 2, {"is a layer of paint", "`neuvv paint info SCENE " + layer + "`"});
    std::filesystem::create_directory(images);
    expect_refused({"info", images}, 2, {"is a folder", "`neuvv dataset " + images + "`"});
}

TEST_F(Cli, AMachineWithoutAVulkanDriverIsTold) {
    const std::string none = "NEUVV_DEVICE= VK_DRIVER_FILES=/none VK_ICD_FILENAMES=/none";
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"devices"}, {"render", scene, "-o", file("x.png"), "--frames", "0"}}) {
        const ProgramResult result = run_neuvv(words, none);
        EXPECT_EQ(result.code, 1);
        EXPECT_NE(result.err.find("no Vulkan driver"), std::string::npos) << result.err;
        EXPECT_NE(result.err.find("mesa-vulkan-drivers"), std::string::npos) << result.err;
    }
}

// File names are any bytes; a glTF file is UTF-8.
TEST_F(Cli, NamesThatAreNoUtf8) {
    const std::string odd = file(
                          "b\xff"
                          "d.nvv"),
                      show = file(
                          "b\xff"
                          "d.gltf");
    std::filesystem::copy_file(scene, odd);
    EXPECT_EQ(run_neuvv({"info", odd, "--json"}).code, 0);
    ASSERT_EQ(run_neuvv({"stage", "new", show}).code, 0);
    ASSERT_EQ(run_neuvv({"stage", "add", show, odd, "--name", "anna"}).code, 0);
    const ProgramResult told = run_neuvv({"stage", "info", show, "--json"});
    EXPECT_EQ(told.code, 0) << told.err;
    EXPECT_NE(told.out.find("\"frames\""), std::string::npos) << "the clip is found: " << told.out;
    expect_refused({"stage", "add", show, odd}, 2, {"not UTF-8", "--name"});
    expect_refused({"stage", "set", show, "anna", "--name", "\xc3\x28"}, 2, {"not UTF-8"});
    EXPECT_EQ(run_neuvv({"stage", "set", show, "anna", "--name", "Zoë 舞"}).code, 0);
}

TEST_F(Cli, AFailedCommandLeavesNoFolder) {
    const std::string deep = file("a/b/c");
    EXPECT_EQ(run_neuvv({"eval", scene, file("none"), "--json", deep + "/x.json", "--images", file("images")}).code, 2);
    EXPECT_EQ(run_neuvv({"render", file("none.nvv"), "-o", deep + "/x.mp4"}).code, 2);
    EXPECT_EQ(run_neuvv({"train", file("none"), "-o", deep + "/x.nvv", "--segment", "2", "--steps", "1"}).code, 2);
    EXPECT_NE(run_neuvv({"capture", file("none.glb"), "-o", deep}, "NEUVV_DEVICE=none").code, 0);
    EXPECT_EQ(run_neuvv({"skeleton", "import", scene, "-o", deep + "/x.glb"}).code, 2);
    EXPECT_EQ(folder.entries(), 1u);
}

// Without a device, so that nothing is drawn.
TEST_F(Cli, WhatIsThereIsKept) {
    for (const char* name : {"cap/images", "rig", "room/plates"}) std::filesystem::create_directories(file(name));
    for (const char* name :
         {"x.mp4", "o_0003.png", "x.nvs", "x.gltf", "cap/images/mine.png", "rig/skeleton.glb", "room/plates/c00.png"})
        write_text(file(name), name);
    const std::string model = NEUVV_SOURCE_DIR "/tools/performer/performer.glb";
    const std::vector<std::vector<std::string>> commands = {{"render", scene, "-o", file("x.mp4")},
                                                            {"render", scene, "-o", file("x.mp4"), "--resume"},
                                                            {"render", scene, "-o", file("o_%04d.png"), "--plan"},
                                                            {"publish", scene, "-o", file("x.nvs")},
                                                            {"convert", scene, "-o", scene},
                                                            {"stage", "new", file("x.gltf")},
                                                            {"skeleton", "import", model, "-o", file("x.glb")},
                                                            {"capture", model, "-o", file("cap")},
                                                            {"capture", model, "-o", file("rig")},
                                                            {"capture", model, "-o", file("room")},
                                                            {"skeleton", "views", scene, "-o", file("cap")},
                                                            {"train", file("data"), "-o", scene}};
    write_text(file("x.glb"), "x.glb");
    for (const std::vector<std::string>& command : commands) {
        const ProgramResult result = run_neuvv(command, "NEUVV_DEVICE=none");
        EXPECT_EQ(result.code, 2) << command[0] << result.err;
        const bool itself = command[0] == "convert";
        EXPECT_NE(result.err.find(itself ? "is what scene names" : "is there already"), std::string::npos)
            << result.err;
    }
    for (const char* name : {"x.mp4", "o_0003.png", "x.nvs", "x.gltf", "x.glb"}) EXPECT_EQ(read_text(file(name)), name);
    ASSERT_EQ(run_neuvv({"stage", "new", file("x.gltf"), "--overwrite"}).code, 0);
    EXPECT_NE(read_text(file("x.gltf")), "x.gltf");
}

TEST_F(Cli, OnlyPartsOfTheTrainingCanBeLeftOut) {
    for (const char* names : {"colour", "merge,colour", "merge,,bound", "merge,"})
        expect_refused({"train", file("data"), "-o", file("x.nvv"), "--leave-out", names}, 2,
                       {"--leave-out", names, "divide, merge, revive, bound, rays"});
}

TEST_F(Cli, ListsMayHaveSpaces) {
    expect_refused({"train", file("data"), "-o", file("x.nvv"), "--refine", "colour, x"}, 2, {"--refine: x: is"});
    expect_refused({"train", file("data"), "-o", file("x.nvv"), "--refine", "none,colour"}, 2, {"--refine: none: is"});
    expect_refused({"train", file("data"), "-o", file("x.nvv"), "--leave-out", "merge, x"}, 2, {"no part \"x\""});
}

TEST_F(Cli, TrainShowsItselfInNoImageOfItsData) {
    std::filesystem::create_directories(file("data/images"));
    const std::string image = file("data/images/c00.png");
    write_text(image, "image");
    expect_refused({"train", file("data"), "-o", file("x.nvv"), "--resume", "--preview", image}, 2,
                   {"--preview", "belongs to"});
    EXPECT_EQ(read_text(image), "image");
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
    expect_refused({"render", scene, "-o", file("x.png"), "--frames", "0:6"}, 2, {"x.png", "105 images", "%04d"});
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
    std::filesystem::create_directory(file("data"));
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
