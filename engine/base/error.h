// The two kinds of errors that modules throw. main and tests catch them; so does code that can go on without what
// failed.
#pragma once

#include <stdexcept>
#include <string>

namespace neuvv {

// A user's bad input: what() is one line, "file: place: what is wrong; fix". Exit code 2.
struct InputError : std::runtime_error {
    // `place` says where in the file the problem is (a chunk, a JSON pointer, a frame); `fix` says what to do. Both may
    // be empty.
    InputError(const std::string& file, const std::string& place, const std::string& problem,
               const std::string& fix = "");
};

// The machine failed: a Vulkan call, a full disk, a missing device feature. what() is one line. Exit code 1.
struct RuntimeFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace neuvv
