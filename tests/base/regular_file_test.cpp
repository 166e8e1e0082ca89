// Pipes, devices and folders in place of files: none may block, and none is read.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/error.h"
#include "base/formats/npz.h"
#include "base/platform.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

TEST(RegularFile, NothingElseIsOpened) {
    const TemporaryFolder folder;
    const std::filesystem::path pipe = folder.path / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::filesystem::create_symlink("pipe", folder.path / "link");
    for (const std::filesystem::path& path :
         {pipe, folder.path / "link", folder.path, std::filesystem::path("/dev/zero"), folder.path / "none"}) {
        EXPECT_THROW(expect_regular_file(path), InputError) << path;
        EXPECT_THROW(read_file(path), InputError) << path;
        EXPECT_THROW(NpzReader{path}, InputError) << path;
    }
    write_text(folder.path / "text", "abc");
    EXPECT_EQ(expect_regular_file(folder.path / "text"), 3u);
    EXPECT_EQ(read_file(folder.path / "text", 3).size(), 3u);
    EXPECT_THROW(read_file(folder.path / "text", 2), InputError);
}

}  // namespace
}  // namespace neuvv
