// Verbs that are run from the window: what their dialogs mean, and how they run.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "support/temporary_folder.h"
#include "tools/viewer/verbs/verb_task.h"

namespace neuvv::viewer {
namespace {

using Arguments = std::vector<std::string>;

TEST(VerbForm, AnInputNamesTheOutputAndEmptyFieldsLeaveOptionsOut) {
    const VerbForm& train = form_of("train");
    std::vector<std::string> values = first_values(train);
    EXPECT_TRUE(output_of(train, values).empty());
    set_input(train, "/data/my studio/", values);
    EXPECT_EQ(arguments_of(train, values),
              (Arguments{"train", "/data/my studio", "-o", "/data/my studio.nvv", "--minutes", "20"}));
    EXPECT_EQ(command_text(arguments_of(train, values)),
              "train '/data/my studio' -o '/data/my studio.nvv' --minutes 20");
    set_input(train, "/data/other", values);
    EXPECT_EQ(output_of(train, values), "/data/my studio.nvv") << "an output that is there stays";

    const VerbForm& exported = form_of("export");
    values = first_values(exported);
    set_input(exported, "/a/b.nvv", values);
    EXPECT_EQ(output_of(exported, values), "/a/b_%04d.ply");
    EXPECT_EQ(command_text(std::vector<std::string>{"it's"}), "'it'\\''s'");
}

TEST(VerbForm, ProgressIsReadFromWhatVerbsPrint) {
    EXPECT_NEAR(progress_of("capture 30/120  elapsed 4.0 s  ETA 12.0 s"), 0.25, 1e-9);
    EXPECT_NEAR(progress_of("15.0 s eta 45.0 s | 300k rays/s | loss 0.1"), 0.25, 1e-9);
    EXPECT_NEAR(progress_of("1:00:00 eta 3:00:00 | 300k rays/s"), 0.25, 1e-9);
    EXPECT_LT(progress_of("wrote a.nvv: 58319 leaves after 420 steps, 15.9 epochs, 42.4 s"), 0);
    EXPECT_LT(progress_of("frames 0/1 of a clip"), 0);
    EXPECT_LT(progress_of(std::string(65536, '1')), 0) << "as long as a line of a program may be";
    EXPECT_NEAR(progress_of("render 1/4  elapsed 1.0 s  " + std::string(65536, 'x')), 0.25, 1e-9);
}

struct RunningVerb : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path program = folder.path / "program";

    void write_program(const std::string& lines) const {
        std::ofstream(program) << "#!/bin/sh\n" << lines;
        std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    }
    static void until(VerbTask& task, const std::function<bool()>& condition) {
        for (int i = 0; i < 12'000 && !condition(); ++i) {
            task.tick();
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        ASSERT_TRUE(condition());
    }
};

TEST_F(RunningVerb, SaysHowFarItIsWhatItPrintsAndHowItEnds) {
    write_program("echo \"$NEUVV_STATUS_MS: $*\"; echo 'x 1/4  elapsed 1.0 s'; echo wrong >&2; exit 1\n");
    VerbTask task("some device", program);
    task.ask("publish", "/a/b.nvv");
    task.overwrite = true;
    task.start();
    EXPECT_TRUE(task.is_running());
    task.ask("train");
    EXPECT_STREQ(task.form().verb, "publish") << "the dialog of what runs stays";
    until(task, [&] { return !task.is_running(); });
    EXPECT_EQ(task.code(), 1);
    EXPECT_NEAR(task.progress(), 0.25, 1e-9);
    ASSERT_EQ(task.lines().size(), 2u);
    EXPECT_EQ(task.lines()[0], "300: publish /a/b.nvv -o /a/b.nvs --quality 47 --overwrite --device some device");
    EXPECT_EQ(task.lines()[1], "wrong");
}

TEST_F(RunningVerb, IsAskedToStopAndMaySaveWhatItHas) {
    write_program("trap 'echo saved; exit 0' INT; echo begun; while :; do sleep 0.02; done\n");
    VerbTask task("", program);
    task.ask("train", "/a");
    task.start();
    until(task, [&] { return !task.lines().empty(); });
    task.stop();
    until(task, [&] { return !task.is_running(); });
    EXPECT_EQ(task.code(), 0);
    EXPECT_EQ(task.lines().back(), "saved");
}

TEST_F(RunningVerb, AProgramThatIsNotThereIsSaid) {
    VerbTask task("", folder.path / "nothing");
    task.ask("train", "/a");
    EXPECT_THROW(task.start(), RuntimeFailure);
    EXPECT_FALSE(task.is_running());
}

}  // namespace
}  // namespace neuvv::viewer
