// Saving in the window while another program edits the same file.
#include "editor/document_saver.h"

#include <gtest/gtest.h>

#include "base/file_lock.h"
#include "edit/operations.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

TEST(DocumentSaver, SaysThatItWaitsForAnotherProgram) {
    const TemporaryFolder folder;
    const std::filesystem::path stage = folder.path / "a.gltf";
    editor::Editor editor;
    editor.open({edit::new_stage(stage), {}, {}}, true);
    editor.take_notices();
    JobQueue jobs([](const std::string& problem) { ADD_FAILURE() << problem; }, [] {});
    editor::DocumentSaver saver(editor, jobs);
    std::optional<EditLock> theirs(std::in_place, stage);
    saver.save(stage);
    const auto next_notice = [&] {
        for (;;) {
            jobs.run_posted();
            if (const std::vector<editor::Notice> notices = editor.take_notices(); !notices.empty())
                return notices.at(0).text;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    };
    EXPECT_EQ(next_notice(), "another program is editing a.gltf: the save waits for it");
    EXPECT_FALSE(std::filesystem::exists(stage));
    theirs.reset();
    EXPECT_EQ(next_notice(), "saved " + stage.string());
    EXPECT_FALSE(saver.saving());
    jobs.stop();
}

}  // namespace
}  // namespace neuvv
