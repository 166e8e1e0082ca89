// What sources that call the operating system share: an open file that is closed, and the message of a call that
// failed.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/error.h"

namespace neuvv {

struct Descriptor {
    int number = -1;
    explicit Descriptor(int descriptor) : number(descriptor) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number >= 0) close(number);
    }
};

// To be called before anything else can change errno. Throws RuntimeFailure.
[[noreturn]] inline void fail_by_errno(const std::filesystem::path& path, const char* what) {
    throw RuntimeFailure(fmt::format("{}: cannot {}: {}", path.string(), what, std::strerror(errno)));
}

}  // namespace neuvv
