// Unsaved edits are stored for recovery, also after the disk has failed for a while.
#include "editor/autosave.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "edit/operations.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

// A folder in which the program keeps its state, for as long as this lives.
class StateFolder {
  public:
    explicit StateFolder(const std::filesystem::path& folder) {
        if (const char* before = std::getenv("XDG_STATE_HOME")) before_ = before;
        setenv("XDG_STATE_HOME", folder.c_str(), 1);
    }
    ~StateFolder() { before_.empty() ? unsetenv("XDG_STATE_HOME") : setenv("XDG_STATE_HOME", before_.c_str(), 1); }

  private:
    std::string before_;
};

TEST(Autosave, TriesAgainAfterAFailure) {
    const TemporaryFolder folder;
    const StateFolder state(folder.path / "state");
    // Where the folder of entries should be, there is a file.
    std::filesystem::create_directories(edit::recovery_folder().parent_path());
    write_text(edit::recovery_folder(), "in the way");
    editor::Editor editor;
    editor.open({edit::new_stage(folder.path / "a.gltf"), {}, {}}, false);
    JobQueue jobs([](const std::string& problem) { ADD_FAILURE() << problem; }, [] {});
    editor::Autosave autosave(editor, jobs);
    autosave.opened();
    ASSERT_TRUE(editor.edit([](edit::Document& document) { return edit::rename_node(document.file, 0, "anna"); }));
    const auto tick = [&](double now_s) {
        autosave.tick(now_s);
        while (!jobs.idle() || jobs.has_posted()) jobs.run_posted();
        return editor.take_notices().size();
    };
    EXPECT_EQ(tick(10), 1u) << "the failure is told";
    EXPECT_EQ(tick(20), 0u) << "once";
    std::filesystem::remove(edit::recovery_folder());
    EXPECT_EQ(tick(30), 1u) << "and that it works again";
    EXPECT_FALSE(std::filesystem::is_empty(edit::recovery_folder()));
    EXPECT_EQ(tick(40), 0u);
    jobs.stop();
}

TEST(Autosave, AnEditIsStoredBeforeItIsFiveSecondsOld) {
    const TemporaryFolder folder;
    const StateFolder state(folder.path / "state");
    editor::Editor editor;
    editor.open({edit::new_stage(folder.path / "a.gltf"), {}, {}}, false);
    JobQueue jobs([](const std::string& problem) { ADD_FAILURE() << problem; }, [] {});
    editor::Autosave autosave(editor, jobs);
    autosave.opened();
    for (const char* name : {"anna", "ben"}) {  // once just after the last time that something was stored
        ASSERT_TRUE(editor.edit([&](edit::Document& document) { return edit::rename_node(document.file, 0, name); }));
        for (const double age_s : {0.1, 4.9}) {
            autosave.tick(100 + (*name == 'b' ? 5 : 0) + age_s);
            while (!jobs.idle() || jobs.has_posted()) jobs.run_posted();
        }
        const std::vector<edit::RecoveryEntry> entries = edit::list_recovery(edit::recovery_folder());
        ASSERT_EQ(entries.size(), 1u);
        EXPECT_EQ(edit::find_node(edit::restore(entries[0]).file, name), 0u);
    }
    jobs.stop();
}

}  // namespace
}  // namespace neuvv
