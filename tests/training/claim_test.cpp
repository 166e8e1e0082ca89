// Claims on runs, by which processes share the training of a clip.
#include "training/run/claim.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.h"

namespace neuvv {
namespace {

struct Claims : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path nvv = folder.path / "000000.nvv", lock = folder.path / "000000.nvv.lock";
};

TEST_F(Claims, OneAtATime) {
    EXPECT_FALSE(training::claim_of(nvv));
    {
        const auto first = training::RunClaim::take(nvv);
        ASSERT_TRUE(first);
        EXPECT_FALSE(training::RunClaim::take(nvv));
        EXPECT_TRUE(training::RunClaim::take(folder.path / "000001.nvv")) << "another run";
        first->report(0.25);
        const auto state = training::claim_of(nvv);
        ASSERT_TRUE(state);
        EXPECT_EQ(state->fraction, 0.25);
        EXPECT_NE(state->owner.find("process " + std::to_string(process_id())), std::string::npos) << state->owner;
    }
    EXPECT_FALSE(training::claim_of(nvv));
    EXPECT_FALSE(std::filesystem::exists(lock)) << "nothing stays behind";
    EXPECT_TRUE(training::RunClaim::take(nvv));
}

TEST_F(Claims, EndWithTheirProcess) {
    const pid_t other = fork();
    if (other == 0) {
        const auto claim = training::RunClaim::take(nvv);
        claim->report(0.5);
        for (;;) pause();
    }
    while (!training::claim_of(nvv) || training::claim_of(nvv)->fraction != 0.5) usleep(1000);
    EXPECT_FALSE(training::RunClaim::take(nvv));
    kill(other, SIGKILL);
    waitpid(other, nullptr, 0);
    EXPECT_TRUE(std::filesystem::exists(lock)) << "it had no time to remove it";
    EXPECT_FALSE(training::claim_of(nvv));
    EXPECT_TRUE(training::RunClaim::take(nvv));
}

// Whoever waits for a file that the owner then removes must not lock what nobody else can find.
TEST_F(Claims, AFileThatIsGoneIsNoLock) {
    std::optional<FileLock> first = FileLock::try_lock(lock);
    ASSERT_TRUE(first);
    std::filesystem::remove(lock);
    const auto second = FileLock::try_lock(lock);
    ASSERT_TRUE(second);
    EXPECT_FALSE(FileLock::try_lock(lock));
    first.reset();
    EXPECT_TRUE(is_file_locked(lock));
}

TEST_F(Claims, WhatTheFileSaysIsNotTrusted) {
    const auto claim = FileLock::try_lock(lock);
    for (const char* text : {"", "{", "[]", R"({"host": 1, "process": "x", "fraction": 7})",
                             R"({"host": "a\u001b[31mb", "process": 3, "fraction": 7})"}) {
        ASSERT_TRUE(claim->write(text));
        const auto state = training::claim_of(nvv);
        ASSERT_TRUE(state) << text;
        EXPECT_TRUE(state->fraction >= 0 && state->fraction <= 1) << text;
        EXPECT_EQ(state->owner.find('\x1b'), std::string::npos) << text;
    }
    EXPECT_EQ(training::claim_of(nvv)->owner, "process 3 of a?[31mb");
    ASSERT_TRUE(claim->write(std::string(100000, ' ')));
    EXPECT_TRUE(training::claim_of(nvv));
}

}  // namespace
}  // namespace neuvv
