// Programs that run beside this one.
#include "base/child_program.h"

#include <gtest/gtest.h>

#include <csignal>

namespace neuvv {
namespace {

TEST(ChildProgram, WhatItPrintsAndHowItEnds) {
    const ProgramOutput output = run_program({"sh", "-c", "echo one; echo two >&2; exit 3"});
    EXPECT_EQ(output.text, "one\ntwo\n");
    EXPECT_EQ(output.code, 3);
    EXPECT_EQ(run_program({"sh", "-c", "kill -TERM $$"}).code, 128 + SIGTERM);
}

// Else a program that is asked to stop, and has much to say then, would never end.
TEST(ChildProgram, WhatNobodyReadsKeepsItFromNothing) {
    const std::string prints = "head -c 300000 /dev/zero | tr '\\0' 'x'; exit 5";
    EXPECT_EQ(ChildProgram({"sh", "-c", prints}).wait(), 5);
    ChildProgram stopped({"sh", "-c", "trap \"" + prints + "\" INT; echo ready; while :; do sleep 0.01; done"});
    while (stopped.next_line(50) != "ready") {
    }
}

TEST(ChildProgram, EndsAlsoWhereThisOneWasStartedWithoutSignalsOfChildren) {
    signal(SIGCHLD, SIG_IGN);
    EXPECT_EQ(run_program({"sh", "-c", "echo one; exit 3"}).code, 3);
    ChildProgram program({"true"});
    signal(SIGCHLD, SIG_IGN);
    EXPECT_EQ(program.wait(), 128) << "nobody knows";
    EXPECT_TRUE(program.has_ended());
    signal(SIGCHLD, SIG_DFL);
}

}  // namespace
}  // namespace neuvv
