// What is opened where a folder is given.
#include "editor/open_file.h"

#include <gtest/gtest.h>

#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

TEST(OpenFile, OfAFolderTheNewestClipThatIsNotHidden) {
    const TemporaryFolder folder;
    const auto now = std::filesystem::file_time_type::clock::now();
    int age_s = 0;
    for (const char* name : {".show.new.nvv", "later.txt", "show.nvv", "before.nvv"}) {
        write_text(folder.path / name, "");
        std::filesystem::last_write_time(folder.path / name, now - std::chrono::seconds(++age_s));
    }
    std::filesystem::create_symlink("round.nvv", folder.path / "round.nvv");  // asking about it is an error
    EXPECT_EQ(editor::stage_of_file(folder.path), folder.path / "show.gltf");
    std::filesystem::remove(folder.path / "show.nvv");
    std::filesystem::remove(folder.path / "before.nvv");
    expect_input_error([&] { editor::stage_of_file(folder.path); }, {folder.path.string(), "there is no .nvv"});
}

}  // namespace
}  // namespace neuvv
