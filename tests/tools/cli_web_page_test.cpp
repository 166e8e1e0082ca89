// neuvv publish --web and neuvv export --as web, without a GPU and with a stand-in for the player.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/text.h"
#include "support/random_tree.h"
#include "support/stage_on_disk.h"
#include "tests/tools/run_neuvv.h"
#include "voctree/files/nvv.h"

namespace neuvv {
namespace {

// The program looks for the player beside its own folder, so these tests run a copy of it.
std::string copied_program() {
    static const TemporaryFolder made;
    static const std::filesystem::path program = made.path / "test" / "neuvv";
    static const bool copied =
        std::filesystem::create_directory(program.parent_path()) && std::filesystem::copy_file(NEUVV_PROGRAM, program);
    EXPECT_TRUE(copied);
    return program.string();
}

struct CliWebPage : testing::Test {
    const std::string program = copied_program();
    const std::filesystem::path player = std::filesystem::path(program).parent_path().parent_path() / "web";
    TemporaryFolder folder;
    const std::string web = (folder.path / "web").string(), stream = (folder.path / "show <1> & 2.nvs").string(),
                      sound = (folder.path / "show <1> & 2.m4a").string();
    const std::set<std::string> player_files = {"index.html", "index.js", "decoder.wasm"},
                                stage_files = {"stage.html", "stage.js", "stage/three.js"};

    void SetUp() override {
        write_player(player_files);
        std::filesystem::copy_file(NEUVV_SOURCE_DIR "/tests/stream/vectors/usual.nvs", stream);
    }
    void write_player(const std::set<std::string>& files) const {
        std::filesystem::remove_all(player);
        std::filesystem::create_directory(player);
        for (const std::string& name : files) write_text(player / name, "the player's " + name);
        write_text(player / "index.html", "<html><title>NeuVV</title><neuvv-player loop></neuvv-player></html>");
        write_text(player / "performer.nvs", "somebody tried the player with it");
        write_list({{"files", files}});
    }
    void write_list(nlohmann::json list) const {
        list["written_by"] = "tools/web/build";
        write_text(player / "player.json", list.dump());
    }
    void write_stage_player() const {
        std::filesystem::create_directory(player / "stage");
        for (const std::string& name : stage_files) write_text(player / name, "the player's " + name);
        write_text(player / "stage.html", "<html><title>NeuVV</title></html>");
        write_list({{"files", player_files}, {"stage_files", stage_files}});
    }
    void edit_stage(const std::string& show, const std::vector<std::string>& words) const {
        std::vector<std::string> arguments = {"stage", words[0], show};
        arguments.insert(arguments.end(), words.begin() + 1, words.end());
        const ProgramResult run = run_neuvv(arguments);
        EXPECT_EQ(run.code, 0) << run.err;
    }
    ProgramResult export_stage(const std::string& show, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {"export", show, "--as", "web", "-o", web};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_program(program, arguments);
    }
    std::string file(const std::string& name) const { return (folder.path / name).string(); }
    std::string page() const { return read_text(web + "/index.html"); }
    ProgramResult publish(const std::string& scene, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {"publish", scene, "--web", web};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_program(program, arguments);
    }
    void expect_published(const std::string& scene, const std::vector<std::string>& more = {}) const {
        const ProgramResult run = publish(scene, more);
        EXPECT_EQ(run.code, 0) << run.err;
    }
    void expect_refused_alone(const ProgramResult& run, const std::vector<std::string>& parts) const {
        expect_refusal(run, 2, parts);
        EXPECT_FALSE(std::filesystem::exists(web)) << "a folder that looks like a page";
    }
    // Of the folder, but for its list.
    std::set<std::string> published_files() const {
        std::set<std::string> names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(web))
            if (!entry.is_directory()) names.insert(entry.path().lexically_relative(web));
        EXPECT_EQ(names.erase("published.json"), 1);
        return names;
    }
    std::set<std::string> player_and(const std::set<std::string>& more) const {
        std::set<std::string> names = player_files;
        names.insert(more.begin(), more.end());
        return names;
    }
};

TEST_F(CliWebPage, AStreamIsCopiedBesideThePlayer) {
    write_text(sound, "sound");
    const ProgramResult run = publish(stream, {"--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto json = nlohmann::json::parse(run.out);
    EXPECT_EQ(json.at("web"), web);
    EXPECT_EQ(json.at("page"), web + "/index.html");
    EXPECT_EQ(json.at("output"), web + "/show.nvs");
    EXPECT_EQ(json.at("bytes"), std::filesystem::file_size(stream));
    EXPECT_EQ(json.at("frames"), 4);
    EXPECT_FALSE(json.contains("psnr_db")) << "nothing was compared";
    EXPECT_EQ(published_files(), player_and({"show.nvs", "show.m4a"}));
    EXPECT_EQ(read_text(web + "/show.nvs"), read_text(stream));
    EXPECT_EQ(read_text(web + "/show.m4a"), "sound");
    EXPECT_EQ(read_text(web + "/decoder.wasm"), "the player's decoder.wasm");
    EXPECT_EQ(page(), "<html><title>show &lt;1&gt; &amp; 2</title><neuvv-player loop></neuvv-player></html>");
}

TEST_F(CliWebPage, AClipIsEncoded) {
    const std::string clip = file("anna.nvv");
    voctree::write_nvv(clip, test::random_tree({.leaves = 100, .frames = 4}));
    expect_published(clip, {"--rate", "1000"});
    EXPECT_EQ(published_files(), player_and({"show.nvs"}));
    EXPECT_NE(page().find("<title>anna</title>"), std::string::npos) << page();
    const ProgramResult info = run_neuvv({"info", web + "/show.nvs", "--json", "--check"});
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(nlohmann::json::parse(info.out).at("frames"), 4);
    const std::string show = file("show.gltf");
    test::write_stage(show, clip, "Ben");
    expect_published(show, {"--rate", "1000", "--overwrite"});
    EXPECT_NE(page().find("<title>Ben</title>"), std::string::npos) << page();
}

TEST_F(CliWebPage, OnlyAnEarlierPageIsReplaced) {
    write_text(sound, "sound");
    expect_published(stream);
    const std::string list = read_text(web + "/published.json");
    write_text(web + "/mine.txt", "mine");
    expect_refusal(publish(stream), 2, {"--web", web, "is there already", "--overwrite"});
    EXPECT_EQ(read_text(web + "/published.json"), list);

    std::filesystem::remove(sound);
    write_player({"index.html", "player.js"});
    expect_published(stream, {"--overwrite"});
    EXPECT_EQ(published_files(), (std::set<std::string>{"index.html", "player.js", "show.nvs", "mine.txt"}))
        << "nothing of the earlier page, and all that is of no page";
    EXPECT_NE(page().find("<neuvv-player sound=\"\" loop>"), std::string::npos) << page();
    write_player({"index.html", "mine.txt"});
    expect_refusal(publish(stream, {"--overwrite"}), 2, {"--web", "mine.txt", "is not of the page"});
    EXPECT_EQ(read_text(web + "/mine.txt"), "mine");
    write_player({"index.html"});
    expect_refusal(publish(web + "/show.nvs", {"--overwrite"}), 2, {"--web", "show.nvs", "scene"});
    EXPECT_EQ(read_text(web + "/show.nvs"), read_text(stream));

    write_text(file("out.txt"), "of somebody else");
    std::filesystem::create_directory_symlink("..", web + "/up");
    for (const char* hostile :
         {R"(["../out.txt"])", R"([".."])", R"(["."])", R"(["up/out.txt"])", R"([3])", R"("out.txt")"}) {
        write_text(web + "/published.json",
                   std::string(R"({"written_by": "neuvv publish", "files": )") + hostile + "}");
        expect_refusal(publish(stream, {"--overwrite"}), 2, {"published.json", "files"});
    }
    write_text(web + "/published.json", R"({"written_by": "a printer", "files": ["mine.txt"]})");
    expect_refusal(publish(stream, {"--overwrite"}), 2, {"published.json", "written_by"});
    EXPECT_EQ(read_text(file("out.txt")), "of somebody else");
    std::filesystem::remove(web + "/published.json");
    expect_refusal(publish(stream, {"--overwrite"}), 2, {"--web", web, "holds other files"});
    EXPECT_EQ(read_text(web + "/mine.txt"), "mine");
    EXPECT_TRUE(std::filesystem::exists(web + "/index.html"));
}

TEST_F(CliWebPage, AnEditedPageStays) {
    expect_published(stream);
    write_text(web + "/index.html", "mine");
    ProgramResult run = publish(stream, {"--overwrite"});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.err.find(web + "/index.html: is not as it was written, and stays"), std::string::npos) << run.err;
    EXPECT_EQ(page(), "mine");
    expect_published(stream, {"--overwrite"});
    EXPECT_EQ(page(), "mine") << "also the next time";
    std::filesystem::remove(web + "/index.html");
    run = publish(stream, {"--overwrite"});
    EXPECT_EQ(run.err.find("not as it was written"), std::string::npos) << run.err;
    EXPECT_NE(page(), "mine");
    auto list = nlohmann::json::parse(read_text(web + "/published.json"));
    list.erase("index_html");
    write_text(web + "/published.json", list.dump());
    const std::string before = page();
    run = publish(stream, {"--overwrite"});
    EXPECT_NE(run.err.find("not as it was written"), std::string::npos)
        << "a list does not say what was written: " << run.err;
    EXPECT_EQ(page(), before);
}

TEST_F(CliWebPage, WhatAKilledRunLeftIsReplaced) {
    std::filesystem::create_directories(web + "/unfinished");
    write_text(web + "/unfinished/show.nvs", "a part");
    expect_published(stream);
    EXPECT_EQ(published_files(), player_and({"show.nvs"}));
}

TEST_F(CliWebPage, APlayerThatIsNotWholeIsNotPublished) {
    std::filesystem::remove(player / "decoder.wasm");
    expect_refused_alone(publish(stream), {player.string(), "decoder.wasm", "run tools/web/build"});
    write_player({"decoder.wasm", "index.html"});
    write_text(player / "index.html", "<html></html>");
    expect_refused_alone(publish(stream), {player.string(), "has no title", "run tools/web/build"});
    std::filesystem::remove(player / "index.html");
    expect_refused_alone(publish(stream), {player.string(), "index.html", "run tools/web/build"});
    std::filesystem::remove(player / "player.json");
    expect_refused_alone(publish(stream), {player.string(), "is not there", "run tools/web/build"});
    std::filesystem::remove_all(player);
    expect_refused_alone(publish(stream), {player.string(), "is not there", "run tools/web/build"});
}

struct CliOneFile : CliWebPage {
    const std::string output = file("show.html");
    const std::string head = R"(<html><title>NeuVV</title><p id="stream"></p><p id="sound"></p>)";

    void SetUp() override {
        CliWebPage::SetUp();
        write_text(player / "one_file.html", head);
    }
    ProgramResult publish_file(const std::string& scene, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {"publish", scene, "--web", output};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_program(program, arguments);
    }
    std::string encoded(const std::string& name) const { return base64(read_file(name)); }
    size_t files() const {
        return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder.path), {}));
    }
};

TEST_F(CliOneFile, HasStreamAndSound) {
    write_text(sound, "sound");
    const size_t before = files();
    const ProgramResult run = publish_file(stream, {"--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(read_text(output), "<html><title>show &lt;1&gt; &amp; 2</title><p id=\"stream\">" + encoded(stream) +
                                     "</p><p id=\"sound\">c291bmQ=</p>");
    const auto json = nlohmann::json::parse(run.out);
    EXPECT_EQ(json.at("page"), output);
    EXPECT_EQ(json.at("bytes"), std::filesystem::file_size(stream));
    EXPECT_EQ(json.at("page_bytes"), std::filesystem::file_size(output));
    EXPECT_EQ(files(), before + 1) << "what it was made of is gone";
    expect_refusal(publish_file(stream), 2, {"--web", output, "is there already", "--overwrite"});
    const std::string clip = file("anna.nvv");
    voctree::write_nvv(clip, test::random_tree({.leaves = 100, .frames = 4}));
    EXPECT_EQ(publish_file(clip, {"--rate", "1000", "--overwrite"}).code, 0);
    EXPECT_TRUE(read_text(output).starts_with("<html><title>anna</title><p id=\"stream\">TlZTdHJlYW0")) << "NVStream";
    EXPECT_TRUE(read_text(output).ends_with("</p><p id=\"sound\"></p>"));
}

TEST_F(CliOneFile, IsRefusedWhereItCannotBeMade) {
    const size_t before = files();
    std::string spaces;
    spaces.resize(20'000'000, ' ');
    write_text(player / "one_file.html", head + spaces);
    expect_refusal(publish_file(stream), 2, {"--web", output, "20.0 MB", "at most 20", "--rate"});
    write_text(player / "one_file.html", "<html><title>NeuVV</title></html>");
    expect_refusal(publish_file(stream), 2, {player.string(), "has no stream"});
    std::filesystem::remove(player / "one_file.html");
    expect_refusal(publish_file(stream), 2, {player.string(), "esbuild", "tools/install-packages web"});
    EXPECT_EQ(files(), before);
}

// A stage with two performers of one clip, of which one is painted, a stream that is shown twice, and a hidden one.
struct CliWebStage : CliWebPage {
    const std::string clip = file("anna.nvv"), show = file("show.gltf");
    const std::set<std::string> own = {"show.glb", "clip_1.nvs", "clip_2.nvs", "clip_3.nvs", "sound_1.m4a"};

    void SetUp() override {
        CliWebPage::SetUp();
        write_stage_player();
        voctree::write_nvv(clip, test::random_tree({.leaves = 100, .frames = 4}));
        write_text(sound, "sound");
        std::filesystem::copy_file(clip, file("secret.nvv"));
        edit_stage(show, {"new"});
        edit_stage(show, {"add", clip, "--name", "anna", "--time", "speed:0.5"});
        edit_stage(show, {"add", clip, "--name", "red"});
        edit_stage(show, {"add", stream, "--name", "ben"});
        edit_stage(show, {"add", stream, "--name", "carla", "--spin", "90"});
        edit_stage(show, {"add", file("secret.nvv"), "--name", "secret"});
        edit_stage(show, {"set", "secret", "--visible", "off"});
        const ProgramResult painted = run_neuvv(
            {"paint", "region", show, file("red.nvpaint"), "--node", "red", "--box", "-9,-9,-9,9,9,9", "--hue", "120"});
        ASSERT_EQ(painted.code, 0) << painted.err;
    }
};

TEST_F(CliWebStage, HasAllThatIsSeenAndHeard) {
    const ProgramResult run = export_stage(show, {"--rate", "1000", "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    std::set<std::string> expected = player_and(own);
    expected.insert({"stage.js", "stage/three.js"});
    EXPECT_EQ(published_files(), expected);
    const auto json = nlohmann::json::parse(run.out);
    EXPECT_EQ(json.at("page"), web + "/index.html");
    EXPECT_EQ(json.at("files"), expected.size() + 1) << "and the list";
    EXPECT_EQ(
        json.at("left_out").dump(),
        R"(["mixtures of frames of \"anna\", whose speed is not 1","\"secret\", which is hidden","shadows on performers"])");
    EXPECT_EQ(page(), "<html><title>show</title></html>");
    const stage::Stage stage = stage::load_stage(web + "/show.glb");
    std::vector<std::string> uris;
    for (const stage::StagePerformer& performer : stage.performers) {
        uris.push_back(performer.name + " " + performer.settings.uri);
        EXPECT_TRUE(performer.settings.paint.empty()) << "it is in the stream";
    }
    EXPECT_EQ(uris,
              (std::vector<std::string>{"anna clip_1.nvs", "red clip_2.nvs", "ben clip_3.nvs", "carla clip_3.nvs"}));
    EXPECT_EQ(stage.performers[2].settings.sound->uri, "sound_1.m4a");
    EXPECT_EQ(stage.performers[3].settings.spin_deg_per_s, 90);
    EXPECT_EQ(stage.duration_s, stage::load_stage(show).duration_s);
    EXPECT_EQ(read_text(web + "/clip_3.nvs"), read_text(stream));
    EXPECT_EQ(read_text(web + "/sound_1.m4a"), "sound");
    EXPECT_NE(read_text(web + "/clip_1.nvs"), read_text(web + "/clip_2.nvs")) << "one of them is painted";
}

TEST_F(CliWebStage, OnlyAnEarlierPageIsReplaced) {
    ASSERT_EQ(export_stage(show, {"--rate", "1000"}).code, 0);
    expect_refusal(export_stage(show), 2, {"--output", web, "is there already", "--overwrite"});
    expect_refusal(export_stage(web + "/show.glb", {"--overwrite"}), 2, {"--output", "show.glb", "scene"});
    write_text(web + "/stage/mine.txt", "mine");
    expect_published(stream, {"--overwrite"});
    EXPECT_EQ(published_files(), player_and({"show.nvs", "show.m4a", "stage/mine.txt"}));
    std::filesystem::remove(web + "/stage/mine.txt");
    const ProgramResult run = export_stage(show, {"--rate", "1000", "--overwrite"});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_TRUE(std::filesystem::exists(web + "/stage/three.js"));
    EXPECT_FALSE(std::filesystem::exists(web + "/show.nvs"));
}

TEST_F(CliWebStage, SaysWhatItNeedsAndWhatItLeavesOut) {
    edit_stage(show, {"set", "anna", "--clip", stream, "--time", "hold"});
    edit_stage(show, {"set", "red", "--clip", stream});
    edit_stage(show, {"set", "--environment", NEUVV_SOURCE_DIR "/tests/golden/stage_time_plain.png"});
    const ProgramResult run = export_stage(show);
    ASSERT_EQ(run.code, 0) << run.err;
    for (const char* line : {"\nleft out: the environment\n", "\nleft out: \"secret\", which is hidden\n",
                             "\nleft out: the paint of \"red\", whose clip is a stream already\n",
                             "\nleft out: shadows on performers\n", "1 stream and 1 sound of 4 performers\n"})
        EXPECT_NE(run.out.find(line), std::string::npos) << run.out;
    EXPECT_EQ(run.out.find("mixtures"), std::string::npos) << run.out;
    edit_stage(show, {"set", "--falloff", "off"});
    const ProgramResult captured = export_stage(show, {"--overwrite"});
    EXPECT_EQ(captured.code, 0) << captured.err;
    EXPECT_EQ(captured.out.find("shadows"), std::string::npos) << captured.out;
    edit_stage(show, {"set", "--falloff", "on", "--shadows", "off"});
    const ProgramResult bright = export_stage(show, {"--overwrite"});
    EXPECT_EQ(bright.code, 0) << bright.err;
    EXPECT_EQ(bright.out.find("shadows"), std::string::npos) << bright.out;
    std::filesystem::remove_all(web);
    expect_refused_alone(export_stage(clip), {"scene", "is no stage"});
    write_player(player_files);
    expect_refused_alone(export_stage(show), {player.string(), "has no three.js", "npm install three"});
}

TEST_F(CliWebPage, WrongUseIsRefused) {
    expect_refused_alone(publish(stream, {"-o", file("x.nvs")}), {"--output", "--web"});
    expect_refusal(run_program(program, {"publish", stream}), 2, {"--output", "--web"});
    expect_refusal(run_program(program, {"publish", stream, "-o", file("x.nvs")}), 2, {"is a stream"});
    for (const std::vector<std::string>& option : std::vector<std::vector<std::string>>{
             {"--rate", "9"}, {"--quality", "40"}, {"--group", "1"}, {"--views", "3"}, {"--size", "64x64"}})
        expect_refused_alone(publish(stream, option), {option[0], stream, "copied as it is"});
    expect_refused_alone(publish(stream, {"--performer", "anna"}), {"--performer", "is for stages"});
    write_text(stream, "no stream");
    expect_refused_alone(publish(stream), {stream});
}

}  // namespace
}  // namespace neuvv
