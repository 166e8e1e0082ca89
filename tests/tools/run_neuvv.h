// Runs the built program, NEUVV_PROGRAM, as a user does.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace neuvv {

struct ProgramResult {
    int code = -1;  // the exit code; -1 where a signal ended the program
    std::string out, err;
};

inline std::string shell_quoted(const std::string& word) {
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

inline ProgramResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                                 const std::string& environment = "", const std::string& redirected = "") {
    const TemporaryFolder streams;
    const auto out = streams.path / "out", err = streams.path / "err";
    std::string command = environment + " " + shell_quoted(program);
    for (const std::string& argument : arguments) command += " " + shell_quoted(argument);
    command += " >" + shell_quoted(out.string()) + " 2>" + shell_quoted(err.string()) + " </dev/null " + redirected;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
}

// `redirected`: what a shell does to its streams beside, such as "2>/dev/full".
inline ProgramResult run_neuvv(const std::vector<std::string>& arguments, const std::string& environment = "",
                               const std::string& redirected = "") {
    return run_program(NEUVV_PROGRAM, arguments, environment, redirected);
}

// Expects that the program ended with this code and one line on stderr, which contains every part.
inline void expect_refusal(const ProgramResult& result, int code, const std::vector<std::string>& parts) {
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    const std::string name = std::filesystem::path(NEUVV_PROGRAM).filename().string();
    EXPECT_EQ(result.err.rfind(name + ": ", 0), 0u) << result.err;
    for (const std::string& part : parts)
        EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
}
inline void expect_refused(const std::vector<std::string>& arguments, int code, const std::vector<std::string>& parts) {
    expect_refusal(run_neuvv(arguments), code, parts);
}

}  // namespace neuvv
