// Reads the words of a text file that another program wrote, and knows the line for errors.
#pragma once

#include <filesystem>
#include <string>

#include "base/error.h"

namespace neuvv::motion {

// All functions throw InputError with the file and its line.
class Words {
  public:
    explicit Words(const std::filesystem::path& file);

    [[noreturn]] void fail(const std::string& problem, const std::string& fix = "") const;
    std::string next();                      // the next word; words are parted by white space
    void expect(const char* word);           // in upper or lower case
    double number(double low, double high);  // the next word as a finite number within these bounds

    // The rest of the current line, without its end; false at the end of the file. Lines of Windows end alike.
    bool line(std::string& text);

  private:
    std::string file_, text_;
    size_t at_ = 0, line_ = 1;
    bool line_ended_ = false;  // line() has read the end of line_
};

}  // namespace neuvv::motion
