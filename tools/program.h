// A program of several verbs: what its errors look like, and the codes with which it ends.
#pragma once

#include "tools/commands.h"

namespace neuvv::tools {

// Sets the options, the version and the error message that every program has. The name of `app` is the program's.
void set_up_program(CLI::App& app, CommonOptions& common);

// Parses the command line, which runs the verb that it names, and returns the exit code: 0, 1 for a failure of the
// machine, 2 for bad input. An error is one line on stderr.
int run_program(CLI::App& app, int argc, char** argv);

}  // namespace neuvv::tools
