// Opening another stage or clip in place of the document; pauses of the program.
#include "tools/headset/next_document.h"

#include <fstream>

#include "headset/panel_at_a_stage.h"
#include "support/environment_value.h"
#include "tools/headset/arrange.h"
#include "tools/headset/program.h"

namespace neuvv::test {
namespace {

struct NextDocumentTest : PanelAtAStage {
    std::filesystem::path other = folder.path / "more/other.gltf";
    NextDocumentTest() {
        std::filesystem::create_directories(other.parent_path());
        stage::StageFile file = edit::new_stage(other);
        edit::PerformerEdit performer;
        performer.clip = clip;
        edit::add_performer(file, "carla", performer, {});
        stage::save_stage_file(file, other);
        std::ofstream(folder.path / "notes.txt") << "no stage";
        std::ofstream(folder.path / ".hidden.gltf") << "";
    }
    // Waits for the job that reads the document.
    void read() {
        for (int i = 0; i < 60'000 && (!jobs.idle() || jobs.has_posted()); ++i) {
            jobs.run_posted();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        jobs.run_posted();
    }
};

TEST_F(NextDocumentTest, AFolderListsWhatCanBeOpened) {
    std::vector<std::string> names;
    for (const headset::FolderEntry& entry : headset::entries_of(folder.path))
        names.push_back(entry.path.filename().string() + (entry.is_folder ? "/" : ""));
    EXPECT_EQ(names, (std::vector<std::string>{"more/", "figure.nvv"}));
    EXPECT_TRUE(headset::entries_of(folder.path / "nowhere").empty());
}

TEST_F(NextDocumentTest, ThePanelLeadsToAFileOrToAnAddress) {
    press("stage page");
    press("open");
    press("file more/");
    press("file other.gltf");
    EXPECT_EQ(opened, other);
    press("open");
    press("file up");
    press("file address");
    press("key https");
    for (const char* key : {"key a", "key .", "key b", "key /", "key c"}) press(key);
    press("key done");
    EXPECT_EQ(opened, "https://a.b/c");
    EXPECT_FALSE(state.editor.modified()) << "nobody is renamed";
}

TEST_F(NextDocumentTest, WhatCannotBeOpenedLeavesTheStageAsItIs) {
    headset::open_other(state, jobs, folder.path / "none.gltf");
    read();
    EXPECT_FALSE(state.next_document);
    EXPECT_TRUE(was_notified("none.gltf"));
    select(kBen);
    headset::duplicate_selected(state);
    draw();
    headset::open_other(state, jobs, other);
    EXPECT_FALSE(state.next_document);
    EXPECT_TRUE(was_notified("save the stage"));
}

TEST_F(NextDocumentTest, ItReplacesTheDocumentOnceItIsRead) {
    const EnvironmentValue config("XDG_CONFIG_HOME", (folder.path / "config").c_str()),
        kept("XDG_STATE_HOME", (folder.path / "state").c_str());
    headset::HeadsetOptions options;
    options.file = clip;
    headset::Program program(options);
    program.open();
    program.start = headset::StandingPlace{};
    headset::open_other(program.state, program.jobs, other);
    for (int i = 0; i < 60'000 && !program.state.next_document->document; ++i) {
        program.jobs.run_posted();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(program.state.next_document->document);
    EXPECT_FALSE(program.open_next()) << "its clips have not been read";
    program.state.next_document->is_read = true;
    EXPECT_TRUE(program.open_next());
    program.state.follow_document();
    ASSERT_EQ(program.state.stage->performers.size(), 1u);
    EXPECT_EQ(program.state.stage->performers[0].name, "carla");
    EXPECT_FALSE(program.start) << "the user gets a place on it";
    EXPECT_FALSE(program.state.editor.modified());
    program.jobs.stop();
}

TEST(HeadsetProgram, TheStagePausesWhileNobodyWearsTheHeadsetOrAMenuIsInFront) {
    const headset::HeadsetOptions options;
    headset::Program program(options);
    const auto plays_with = [&](bool is_worn, bool has_focus) {
        program.is_worn = is_worn;
        program.has_focus = has_focus;
        program.pause_unattended();
        return program.state.clock.playing;
    };
    EXPECT_FALSE(plays_with(true, true)) << "it did not play before";
    program.state.clock.playing = true;
    EXPECT_TRUE(plays_with(true, true));
    EXPECT_FALSE(plays_with(false, true));
    EXPECT_FALSE(plays_with(false, false));
    EXPECT_FALSE(plays_with(true, false));
    EXPECT_TRUE(plays_with(true, true)) << "it goes on";
    program.jobs.stop();
}

}  // namespace
}  // namespace neuvv::test
