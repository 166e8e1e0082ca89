// Programs that run beside this one.
#include "base/child_program.h"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "support/temporary_folder.h"

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

TEST(ChildProgram, StopsAlsoWhereThisOneRunsInTheBackground) {
    const auto before = signal(SIGINT, SIG_IGN);
    ChildProgram program({"sh", "-c", "trap 'exit 5' INT; echo ready; while :; do sleep 0.01; done"});
    while (program.next_line(50) != "ready") {
    }
    program.stop();
    EXPECT_EQ(program.wait(), 5);
    signal(SIGINT, before);
}

TEST(ChildProgram, EndsAlsoWhereThisOneWasStartedWithoutSignalsOfChildren) {
    signal(SIGCHLD, SIG_IGN);
    EXPECT_EQ(run_program({"sh", "-c", "echo one; exit 3"}).code, 3);

    // The system forgets how a child ended only if the signal is ignored when it ends: this one waits for a file.
    const TemporaryFolder folder;
    const std::string go = folder.path / "go";
    ChildProgram program({"sh", "-c", "while ! [ -e '" + go + "' ]; do sleep 0.01; done"});
    signal(SIGCHLD, SIG_IGN);
    std::ofstream(go).close();
    while (!program.has_ended()) program.next_line(10);
    EXPECT_EQ(program.wait(), 128) << "nobody knows";
    signal(SIGCHLD, SIG_DFL);
}

}  // namespace
}  // namespace neuvv
