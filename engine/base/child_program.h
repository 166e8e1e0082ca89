// A program that runs beside this one and whose lines are read while it runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/line_reader.h"

namespace neuvv {

class ChildProgram {
  public:
    // Starts a program, by its path or of PATH, without a shell; the first argument is its name. What it prints to
    // stdout and stderr comes as lines; its stdin is empty. `environment` has NAME=VALUE, beside what this process has.
    // Throws RuntimeFailure where it cannot be started.
    ChildProgram(std::vector<std::string> arguments, const std::vector<std::string>& environment = {});
    // Asks a program that still runs to stop, and waits until it has.
    ~ChildProgram();
    ChildProgram(const ChildProgram&) = delete;
    ChildProgram& operator=(const ChildProgram&) = delete;

    // The next line that it has printed; nullopt where there is none within `wait_ms`, or when it has closed its
    // output.
    std::optional<std::string> next_line(int wait_ms = 0);
    // Whether it has ended and all of its lines have been taken.
    bool has_ended();
    // Waits for the end. The exit code; 128 plus the signal's number where a signal ended it.
    int wait();
    // Asks it to stop, as Ctrl-C does.
    void stop() const;

  private:
    bool reap(int flags);

    int process_ = 0, output_ = -1;
    std::optional<LineReader> lines_;
    bool closed_ = false;  // its output
    std::optional<int> code_;
};

// Runs a program of PATH to its end, without a shell. The first argument is the program's name. Throws RuntimeFailure
// where it cannot be started.
struct ProgramOutput {
    int code = 0;      // the exit code; 128 plus the signal's number where a signal ended it
    std::string text;  // of stdout and stderr
};
ProgramOutput run_program(std::vector<std::string> arguments);

}  // namespace neuvv
