// The two kinds of failure that cross module borders. Only main and tests catch them.
#pragma once

#include <stdexcept>
#include <string>

namespace neuvv {

// A user's bad input: what() is one line, "file: place: what is wrong; fix". Exit code 2.
struct InputError : std::runtime_error {
    // `place` is where in the file (a chunk, a JSON pointer, a frame), may be empty; `fix` says what to do, may be
    // empty.
    InputError(const std::string& file, const std::string& place, const std::string& problem,
               const std::string& fix = "");
};

// The machine failed us: a Vulkan call, a full disk, a missing device feature. One line. Exit code 1.
struct RuntimeFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace neuvv
