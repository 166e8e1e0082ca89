// Errors on the command line: what a library says of the cause, and the remedy by options and verbs of this program.
#pragma once

#include <exception>
#include <string>

#include "base/error.h"

namespace neuvv::tools {

// The message of an error for a terminal, "cause; what to do". A setting is named by its option.
std::string message_of(const std::exception& error);
std::string message_of(const Note& note);

}  // namespace neuvv::tools
