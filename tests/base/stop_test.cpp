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
void work_on_for_two_seconds() {
    if (!stop_requested()) _exit(8);
    for (unsigned left_s = 2; left_s > 0;) left_s = sleep(left_s);
}
void end_at_once() {}

TEST(Stop, WhatNobodyAsksForEndsWhatBlocks) {
    const int blocked = status_of(1, wait_for_ever);
    EXPECT_TRUE(WIFSIGNALED(blocked) && WTERMSIG(blocked) == SIGTERM) << blocked;
    EXPECT_EQ(WEXITSTATUS(status_of(1, work_on_for_two_seconds)), 7) << "it knows of the request";
    EXPECT_EQ(WEXITSTATUS(status_of(kEndless, end_at_once)), 7);
}

}  // namespace
}  // namespace neuvv
