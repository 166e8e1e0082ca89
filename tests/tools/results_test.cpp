// Results are neither what the command line names otherwise nor what is there already.
#include "tools/results.h"

#include <gtest/gtest.h>

#include "support/input_error.h"
#include "support/stage_on_disk.h"
#include "support/temporary_folder.h"
#include "tools/help_text.h"

namespace neuvv::tools {
namespace {

struct Results : testing::Test {
    TemporaryFolder folder;

    std::filesystem::path file(const std::string& name) const { return folder.path / name; }
    // As of `neuvv verb INPUT --result`, with --overwrite.
    void give(const std::filesystem::path& input, bool overwrite = true) {
        set_given_paths({{{"input", input}}, overwrite});
    }
    void refuse(const std::filesystem::path& result, const std::string& part) {
        const std::string before = std::filesystem::is_regular_file(result) ? read_text(result) : "";
        expect_input_error([&] { prepare_result("--result", result); }, {"--result", result.string(), part});
        if (!before.empty()) {
            EXPECT_EQ(read_text(result), before);
        }
    }
    void TearDown() override { set_given_paths({}); }
};

TEST_F(Results, AreNotWhatTheCommandReads) {
    write_text(file("in.json"), "in");
    give(file("in.json"));
    std::filesystem::create_hard_link(file("in.json"), file("hard.json"));
    std::filesystem::create_symlink("in.json", file("soft.json"));
    std::filesystem::create_directory(file("sub"));
    std::filesystem::create_directory_symlink("sub/..", file("round"));
    for (const char* name : {"in.json", "hard.json", "soft.json", "sub/../in.json", "round/in.json"})
        refuse(file(name), "is what input names, too");
    // Two results that are not there yet, and would be one file.
    set_given_paths({{{"--html", file("new.json")}}, true});
    refuse(file("sub/../new.json"), "is what --html names, too");
    prepare_result("--html", file("new.json"));
    // Lists name their parts, with settings behind colons.
    set_given_paths({{{"--paint", file("a.nvpaint").string() + "," + file("in.json").string() + ":tint:0.8"}}, true});
    refuse(file("in.json"), "is what --paint names, too");
}

TEST_F(Results, AreNoPartOfWhatTheCommandReads) {
    std::filesystem::create_directories(file("data/images"));
    std::filesystem::create_directories(file("long.nvv"));
    for (const char* name :
         {"data/transforms.json", "data/images/a.png", "data/old.nvv", "long.nvv/clip.json", "long.nvv/000000.nvv"})
        write_text(file(name), "{}");
    give(file("data"));
    refuse(file("data/transforms.json"), "belongs to");
    refuse(file("data/images/a.png"), "belongs to");
    prepare_result("--result", file("data/images/b.png"));  // it is not there
    prepare_result("--result", file("data/old.nvv"));       // a result of an earlier command
    for (const char* name : {"data/images/a.png", "data/images/b.png"})
        expect_input_error([&] { expect_no_input("--preview", file(name)); }, {"--preview", name, "belongs to"});
    for (const char* name : {"data/log.jsonl", "b.png"}) expect_no_input("--preview", file(name));
    give(file("long.nvv"));
    refuse(file("long.nvv/000000.nvv"), "belongs to");
    give(file("long.nvv/"));
    refuse(file("long.nvv/clip.json"), "belongs to");

    test::write_stage(file("show.gltf"), file("my clip.nvv"), "anna");
    write_text(file("my clip.nvv"), "clip");
    give(file("show.gltf"));
    refuse(file("my clip.nvv"), "belongs to");
    refuse(file("show.gltf"), "is what input names, too");
}

TEST_F(Results, AreKeptUnlessTheUserSaysOtherwise) {
    write_text(file("old.json"), "old");
    give(file("in.nvv"), false);
    refuse(file("old.json"), "--overwrite");
    prepare_result("--result", file("new.json"));
    expect_input_error(
        [&] {
            prepare_results("--result", folder.path, {"new.json", "old.json"});
        },
        {"is there already"});
    const media::ImageOutput images = media::parse_output(file("o_%04d.png").string());
    write_text(file("o_0002.png"), "image");
    prepare_images("--result", images, 0, 2);
    expect_input_error([&] { prepare_images("--result", images, 0, 3); }, {"o_0002.png", "is there already"});
    give(file("in.nvv"), true);
    prepare_result("--result", file("old.json"));
    prepare_images("--result", images, 0, 3);
    EXPECT_EQ(read_text(file("old.json")), "old") << "until the new one is written";
}

TEST_F(Results, HaveTheirEndings) {
    give(file("in.nvv"));
    expect_input_error([&] { prepare_result("--html", file("a.nvv"), kHtmlEndings); }, {"--html", ".html or .htm"});
    prepare_result("--html", file("A.HTM"), kHtmlEndings);
}

TEST(HelpText, IsFilledAnew) {
    const std::string words(120, 'x');
    EXPECT_EQ(filled("One line\nand its rest.\nAnother.\n\n  kept as  it is\n"),
              "One line and its rest.\nAnother.\n\n  kept as  it is\n");
    std::string long_line = "  neuvv verb";
    for (int i = 0; i < 12; ++i) long_line += " --option value";
    const std::string broken = filled(long_line);
    EXPECT_NE(broken.find(" \\\n      --option value"), std::string::npos) << broken;
    EXPECT_EQ(broken.find("--option \\"), std::string::npos) << "a value stays with its option: " << broken;
    EXPECT_EQ(help_entry("-s", "short", 10), "  -s      short\n");
    EXPECT_EQ(help_entry("--longer-name", "long", 10), "  --longer-name\n          long\n");
    EXPECT_EQ(filled(words), words + "\n") << "a word that is too long stays whole";
}

TEST(HelpText, NearNames) {
    const std::vector<std::string> names = {"train", "render", "eval", "export", "devices", "xr"};
    EXPECT_EQ(nearest_name("trian", names), "train");
    EXPECT_EQ(nearest_name("Render", names), "render");
    EXPECT_EQ(nearest_name("exprot", names), "export");
    EXPECT_EQ(nearest_name("dev", names), "devices");
    EXPECT_EQ(nearest_name("sing", names), "");
    EXPECT_EQ(nearest_name("a", names), "");
}

}  // namespace
}  // namespace neuvv::tools
