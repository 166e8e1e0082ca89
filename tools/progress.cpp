#include "tools/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/platform.h"

namespace neuvv {

namespace {
constexpr std::chrono::milliseconds kSilence{2000}, kTerminalPause{100}, kLogPause{10000};
constexpr const char* kClearLine = "\r\x1b[K";
}  // namespace

std::string clock_text(double seconds) {
    const auto whole = static_cast<uint64_t>(std::lround(std::clamp(seconds, 0.0, 1e9)));
    const uint64_t hours = whole / 3600, minutes = whole / 60 % 60;
    if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
    return fmt::format("{}:{:02}", minutes, whole % 60);
}

Progress::Progress(std::string label, uint64_t total)
    : label_(std::move(label)),
      total_(std::max<uint64_t>(total, 1)),
      terminal_(stderr_is_terminal()),
      start_(Clock::now()),
      next_(start_ + kSilence) {}

Progress::~Progress() {
    finish();
}

void Progress::update(uint64_t done, std::string detail) {
    const Clock::time_point now = Clock::now();
    if (now < next_) return;
    next_ = now + (terminal_ ? kTerminalPause : kLogPause);
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    std::string line = fmt::format("{} {}/{} ({:.0f} %), {}", label_, done, total_, 100 * share, clock_text(elapsed));
    if (share > 0) line += fmt::format(", {} left", clock_text(elapsed / share - elapsed));
    if (!detail.empty()) line += "  " + detail;
    if (terminal_)
        fmt::print(stderr, "{}{}", kClearLine, line);
    else
        fmt::print(stderr, "{}\n", line);
    std::fflush(stderr);
    line_open_ = terminal_;
}

void Progress::finish() {
    if (line_open_) fmt::print(stderr, "{}", kClearLine);
    std::fflush(stderr);
    line_open_ = false;
}

}  // namespace neuvv
