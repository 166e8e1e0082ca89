#include "tools/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/platform.h"

namespace neuvv::tools {

namespace {
constexpr std::chrono::milliseconds kTerminalPeriod{200}, kLogPeriod{10000};
}

std::string format_duration(double seconds) {
    if (!(seconds >= 0) || seconds > 1e7) return "?";
    if (seconds < 60) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<uint64_t>(seconds);
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

Progress::Progress(std::string label, uint64_t total)
    : label_(std::move(label)), total_(total), terminal_(stderr_is_terminal()), start_(Clock::now()), next_(start_) {
    if (!terminal_) next_ += kLogPeriod;
}

Progress::~Progress() {
    finish();
}

void Progress::update(uint64_t done, std::string detail) {
    done_ = done;
    detail_ = std::move(detail);
    dirty_ = true;
    const Clock::time_point now = Clock::now();
    if (now < next_) return;
    next_ = now + (terminal_ ? kTerminalPeriod : kLogPeriod);
    print();
}

void Progress::finish() {
    if (std::exchange(finished_, true)) return;
    if (dirty_) print();
    if (terminal_ && printed_ > 0) fmt::print(stderr, "\n");
}

void Progress::print() {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    std::string line = fmt::format("{} {}/{}  elapsed {}", label_, done_, total_, format_duration(elapsed));
    if (done_ > 0 && done_ < total_)
        line += "  ETA " + format_duration(elapsed * static_cast<double>(total_ - done_) / static_cast<double>(done_));
    if (!detail_.empty()) line += "  " + detail_;
    const size_t length = line.size();
    if (terminal_) {
        if (length < printed_) line.append(printed_ - length, ' ');  // over the longer line before
        fmt::print(stderr, "\r{}", line);
        printed_ = length;
    } else {
        fmt::print(stderr, "{}\n", line);
    }
    std::fflush(stderr);
    dirty_ = false;
}

}  // namespace neuvv::tools
