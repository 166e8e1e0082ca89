// Files that are written beside their place: under names that nobody can guess, and that killed processes do not leave
// for ever.
#include "base/new_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdarg>
#include <functional>
#include <optional>

#include "base/descriptor.h"
#include "base/error.h"
#include "support/temporary_folder.h"

namespace {
std::function<void(int descriptor)> before_lock;  // called before each lock that is asked for in this program
}

// In place of the C library's, for all of this program.
extern "C" int fcntl(int descriptor, int command, ...) {
    va_list arguments;
    va_start(arguments, command);
    void* const argument = va_arg(arguments, void*);
    va_end(arguments);
    if (command == F_OFD_SETLK && before_lock) before_lock(descriptor);
    return static_cast<int>(syscall(SYS_fcntl, descriptor, command, argument));
}

namespace neuvv {
namespace {

void put(NewFile& file, const std::string& text) {
    file.write(text.data(), text.size());
}
void put(const std::filesystem::path& path, const std::string& text) {
    write_file_atomically(path, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

mode_t mode_of(const std::filesystem::path& path) {
    struct stat what = {};
    EXPECT_EQ(stat(path.c_str(), &what), 0);
    return what.st_mode & 07777;
}

std::filesystem::path temporary_in(const std::filesystem::path& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename().string().front() == '.') return entry.path();
    return {};
}

// Ends without running any destructor, as a killed process does.
void be_killed_while_writing(const std::filesystem::path& path) {
    const pid_t child = fork();
    if (child == 0) {
        NewFile file(path);
        put(file, "half");
        raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
}

TEST(NewFile, SeveralWritersOfOnePathEachHaveTheirOwn) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "show.mp4";
    NewFile first(path), second(path);
    put(first, "the first, which is longer");
    put(second, "the second");
    first.finish();
    EXPECT_EQ(read_text(path), "the first, which is longer");
    second.finish();
    EXPECT_EQ(read_text(path), "the second");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(NewFile, WhatIsNotFinishedLeavesNothing) {
    const TemporaryFolder folder;
    put(folder.path / "a", "old");
    {
        NewFile file(folder.path / "a");
        put(file, "new");
        EXPECT_EQ(folder.entries(), 2u);
        NewFile moved = std::move(file);
    }
    EXPECT_EQ(read_text(folder.path / "a"), "old");
    EXPECT_EQ(folder.entries(), 1u);
    EXPECT_THROW(NewFile(folder.path / "missing" / "a"), RuntimeFailure);
}

TEST(NewFile, PartsAreWrittenOverAndLibrariesOpenItByName) {
    const TemporaryFolder folder;
    NewFile file(folder.path / "a");
    put(file, "0000 and more");
    std::ofstream(file.name_to_open(), std::ios::in | std::ios::out) << "name";
    file.write_at(2, "xx", 2);
    EXPECT_EQ(read_text(file.name_to_open()), "naxx and more");
    file.finish(NewFile::Sync::kNo);
    EXPECT_EQ(read_text(folder.path / "a"), "naxx and more");
}

// Whoever writes into the folder next removes it, whatever the file's name; but not what somebody still writes.
TEST(NewFile, WhatAKilledProcessLeavesIsRemovedByTheNextWriter) {
    const TemporaryFolder folder;
    be_killed_while_writing(folder.path / "show.mp4");
    const std::filesystem::path left = temporary_in(folder.path);
    ASSERT_FALSE(left.empty());
    write_text(folder.path / ".mine.neuvv-notes", "a name that only begins like one");
    put(folder.path / "other.mp4", "whole");
    EXPECT_FALSE(std::filesystem::exists(left));
    EXPECT_EQ(read_text(folder.path / ".mine.neuvv-notes"), "a name that only begins like one");
    EXPECT_EQ(folder.entries(), 2u);
}

TEST(NewFile, WhatALivingProcessWritesIsLeftAlone) {
    const TemporaryFolder folder;
    NewFile written(folder.path / "show.mp4");
    const pid_t child = fork();
    if (child == 0) {
        std::filesystem::create_directory_symlink(folder.path, folder.path / "seen_anew");
        NewFile other(folder.path / "seen_anew" / "other.mp4");
        _exit(std::filesystem::exists(folder.path / "seen_anew") ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    put(written, "whole");
    written.finish();
    EXPECT_EQ(read_text(folder.path / "show.mp4"), "whole");
}

// A process that cleans the folder comes between the creation of a file and its lock, and is slow to remove it.
TEST(NewFile, AFileThatIsTakenForAbandonedBeforeItsLockGetsAnotherName) {
    const TemporaryFolder folder;
    std::filesystem::path taken;
    std::optional<Descriptor> cleaner;
    before_lock = [&](int created) {
        before_lock = {};
        taken = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(created));
        cleaner.emplace(open(taken.c_str(), O_RDWR | O_CLOEXEC));
        struct flock whole = {};
        whole.l_type = F_WRLCK;
        whole.l_whence = SEEK_SET;
        ASSERT_EQ(fcntl(cleaner->number, F_OFD_SETLK, &whole), 0);
    };
    NewFile file(folder.path / "a");
    ASSERT_TRUE(cleaner);
    unlink(taken.c_str());
    put(file, "new");
    EXPECT_NO_THROW(file.finish());
    EXPECT_EQ(read_text(folder.path / "a"), "new");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(NewFile, NoGuessedLinkLeadsElsewhere) {
    const TemporaryFolder folder, victims;
    write_text(victims.path / "victim", "dear");
    const std::string name = (folder.path / "a.nvs").string();
    for (const char* ending : {".tmp", ".part", ".sound", ".tmp.mp4", ".tmp.m4a"})
        std::filesystem::create_symlink(victims.path / "victim", name + ending);
    std::filesystem::create_symlink(victims.path / "victim", name + ".tmp" + std::to_string(getpid()));
    put(name, "new");
    EXPECT_EQ(read_text(name), "new");
    EXPECT_EQ(read_text(victims.path / "victim"), "dear");
}

TEST(NewFile, AReplacedFileKeepsItsPermissionsAndItsLink) {
    const TemporaryFolder folder;
    const mode_t umask_before = umask(022);
    for (const mode_t mode : {0600, 0640, 0664, 0777, 0400 | 0200}) {
        put(folder.path / "a", "old");
        ASSERT_EQ(chmod((folder.path / "a").c_str(), mode), 0);
        put(folder.path / "a", "new");
        EXPECT_EQ(mode_of(folder.path / "a"), mode);
    }
    put(folder.path / "fresh", "new");
    EXPECT_EQ(mode_of(folder.path / "fresh"), 0644u) << "as the umask says";
    umask(umask_before);
    std::filesystem::create_symlink("a", folder.path / "link");
    put(folder.path / "link", "through the link");
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path / "link"));
    EXPECT_EQ(read_text(folder.path / "a"), "through the link");
}

TEST(NewFile, AReplacedFileIsReadableToNobodyElseWhileItIsWritten) {
    const TemporaryFolder folder;
    put(folder.path / "secret", "old");
    for (const mode_t mode : {0600, 0640, 0660}) {  // the group of what is written is not yet that of the file
        ASSERT_EQ(chmod((folder.path / "secret").c_str(), mode), 0);
        const NewFile file(folder.path / "secret");
        EXPECT_EQ(mode_of(temporary_in(folder.path)), 0600u);
    }
}

TEST(NewFile, WriteProtectedFilesStay) {
    const TemporaryFolder folder;
    put(folder.path / "a", "dear");
    ASSERT_EQ(chmod((folder.path / "a").c_str(), 0444), 0);
    EXPECT_THROW(put(folder.path / "a", "new"), RuntimeFailure);
    std::filesystem::create_symlink("a", folder.path / "link");
    EXPECT_THROW(put(folder.path / "link", "new"), RuntimeFailure);
    put(folder.path / "b", "new");
    EXPECT_THROW(replace_file(folder.path / "a", folder.path / "b"), RuntimeFailure);
    EXPECT_EQ(read_text(folder.path / "a"), "dear");
    ASSERT_EQ(mkfifo((folder.path / "pipe").c_str(), 0600), 0);
    EXPECT_THROW(put(folder.path / "pipe", "new"), RuntimeFailure);
    EXPECT_THROW(put(folder.path, "new"), RuntimeFailure);
    {
        NewFile file(folder.path / "b");  // protected while it is written
        ASSERT_EQ(chmod((folder.path / "b").c_str(), 0444), 0);
        EXPECT_THROW(file.finish(), RuntimeFailure);
    }
    EXPECT_EQ(read_text(folder.path / "b"), "new");
    EXPECT_EQ(folder.entries(), 4u);
}

TEST(NewFile, LongNamesLeaveRoomForWhatIsAdded) {
    const TemporaryFolder folder;
    const std::string name(250, 'n');
    put(folder.path / name, "new");
    EXPECT_EQ(read_text(folder.path / name), "new");
}

}  // namespace
}  // namespace neuvv
