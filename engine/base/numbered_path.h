// Paths of numbered files, as a user writes them: out_%04d.png.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace neuvv {

class NumberedPath {
  public:
    // Nothing where the last % of the text does not begin a place for a number, %d or %0Nd with N of 1 to 9.
    static std::optional<NumberedPath> parse(const std::string& text);

    std::string file(uint64_t number) const;
    // The path with this text in place of the number.
    std::string file(const std::string& in_place_of_number) const { return before_ + in_place_of_number + after_; }

  private:
    std::string before_, after_;
    int digits_ = 1;  // at least so many
};

}  // namespace neuvv
