// What a request to stop ends.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "base/platform.h"

namespace neuvv {
namespace {

// How a process ends that gets SIGTERM while it does `work`.
int status_of(unsigned patience_s, void (*work)()) {
    const pid_t child = fork();
    if (child == 0) {
        catch_stop_signals(patience_s);
        raise(SIGTERM);
        work();
        _exit(7);
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return status;
}

void wait_for_ever() {
    int ends[2];
    char byte = 0;
    if (pipe(ends) == 0 && read(ends[0], &byte, 1) == 1) _exit(8);
}
// The alarm comes here and now: a busy machine may be late with the work, or with the alarm.
void work_on_after_the_alarm() {
    if (!stop_requested()) _exit(8);
    if (alarm(0) == 0) _exit(9);
    raise(SIGALRM);
}
// `timeout` sends several signals: to the program and to its group.
void be_asked_again_at_once() {
    for (int i = 0; i < 2; ++i) raise(SIGTERM);
}
void end_at_once() {}

TEST(Stop, WhatNobodyAsksForEndsWhatBlocks) {
    const int blocked = status_of(1, wait_for_ever);
    EXPECT_TRUE(WIFSIGNALED(blocked) && WTERMSIG(blocked) == SIGTERM) << blocked;
    constexpr unsigned kLong_s = 1000;
    EXPECT_EQ(WEXITSTATUS(status_of(kLong_s, work_on_after_the_alarm)), 7) << "it knows of the request";
    EXPECT_EQ(WEXITSTATUS(status_of(kEndless, end_at_once)), 7);
}

TEST(Stop, SignalsThatComeTogetherAreOneRequest) {
    EXPECT_EQ(WEXITSTATUS(status_of(kEndless, be_asked_again_at_once)), 7);
}

}  // namespace
}  // namespace neuvv
