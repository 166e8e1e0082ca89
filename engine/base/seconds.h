// The clock by which the program measures its own work.
#pragma once

#include <chrono>

namespace neuvv {

// Seconds since some fixed moment; the clock never goes back.
inline double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace neuvv
