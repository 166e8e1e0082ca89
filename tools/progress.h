// One line that says how far a long task is: redrawn on a terminal, a new line every 10 s in a log. To stderr.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace neuvv::tools {

class Progress {
  public:
    Progress(std::string label, uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // Cheap to call often. `detail` follows the figures.
    void update(uint64_t done, std::string detail = "");
    // Prints the last state and ends the line; the destructor does so too.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;
    void print();

    std::string label_, detail_;
    uint64_t total_, done_ = 0;
    bool terminal_, finished_ = false, dirty_ = false;
    size_t printed_ = 0;  // characters of the line on the terminal
    Clock::time_point start_, next_;
};

// "4.2 s", "3:07", "1:02:30"
std::string format_duration(double seconds);

}  // namespace neuvv::tools
