// Whoever reads, changes and writes a file keeps others from that meanwhile.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>
#include <vector>

#include "base/error.h"
#include "base/file_lock.h"
#include "base/platform.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

TEST(EditLock, NoChangeIsLost) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path / "count", link = folder.path / "link";
    write_text(file, "0");
    std::filesystem::create_symlink("count", link);
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&, i] {
            const std::filesystem::path& path = i % 2 ? link : file;
            for (int k = 0; k < 5; ++k) {
                const EditLock lock(path);
                const std::string text = std::to_string(std::stoi(read_text(path)) + 1);
                write_file_atomically(path, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(read_text(file), "20");
    EXPECT_EQ(folder.entries(), 2u) << "the lock stayed";
}

TEST(EditLock, WhoeverMayWriteTheFolderMayLock) {
    const TemporaryFolder folder;
    const auto mode_in_folder_of = [&](mode_t mode) {
        EXPECT_EQ(chmod(folder.path.c_str(), mode), 0);
        const EditLock lock(folder.path / "file");
        struct stat what = {};
        EXPECT_EQ(stat((folder.path / ".file.lock").c_str(), &what), 0);
        return what.st_mode & 0777;
    };
    const mode_t umask_before = umask(077);
    EXPECT_EQ(mode_in_folder_of(0755), 0600u);
    EXPECT_EQ(mode_in_folder_of(0775), 0660u);
    EXPECT_EQ(mode_in_folder_of(0777), 0666u);
    umask(umask_before);
}

// Of a user whose file nobody else may write.
TEST(EditLock, AnotherUsersLockIsWaitedFor) {
    constexpr uid_t kNobody = 65534;
    if (geteuid() != 0) GTEST_SKIP() << "needs the superuser, who becomes another user";
    const TemporaryFolder folder;
    ASSERT_EQ(chmod(folder.path.c_str(), 0777), 0);
    const EditLock lock(folder.path / "file");
    ASSERT_EQ(chmod((folder.path / ".file.lock").c_str(), 0644), 0);
    const pid_t child = fork();
    if (child == 0) {
        if (setuid(kNobody) != 0) _exit(2);
        const EditLock other(folder.path / "file", [] { _exit(0); });
        _exit(1);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}

TEST(EditLock, AFolderHasOneLockWithASlashAndWithout) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path / "look.nvpaint");
    const EditLock lock(folder.path / "look.nvpaint/");
    EXPECT_TRUE(is_file_locked(folder.path / ".look.nvpaint.lock"));
}

TEST(FileLock, NoFileOfAnotherNameIsTaken) {
    const TemporaryFolder folder;
    write_text(folder.path / "dear", "dear");
    std::filesystem::create_hard_link(folder.path / "dear", folder.path / "hard");
    std::filesystem::create_symlink("dear", folder.path / "soft");
    for (const char* name : {"hard", "soft"}) EXPECT_THROW(FileLock(folder.path / name), RuntimeFailure) << name;
}

TEST(EditLock, WhereThereCanBeNoneNobodyIsKept) {
    const TemporaryFolder folder;
    const EditLock missing(folder.path / "none" / "file");
    std::filesystem::create_directory(folder.path / ".file.lock");  // somebody's folder
    const EditLock first(folder.path / "file"), second(folder.path / "file");
    EXPECT_TRUE(std::filesystem::exists(folder.path / ".file.lock"));
}

}  // namespace
}  // namespace neuvv
