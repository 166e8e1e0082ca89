// A line on stderr that says how far a long operation is and how long it will take.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace neuvv {

// "1:02:03", "2:03", "0:03".
std::string clock_text(double seconds);

// Silent for the first two seconds. Then, on a terminal, one line that is rewritten; else a line every ten seconds.
class Progress {
  public:
    Progress(std::string label, uint64_t total);
    ~Progress();  // leaves the terminal's line, as finish() does
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void update(uint64_t done, std::string detail = "");
    // Takes the line away.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;
    std::string label_;
    uint64_t total_;
    bool terminal_;
    bool line_open_ = false;
    Clock::time_point start_, next_;
};

}  // namespace neuvv
