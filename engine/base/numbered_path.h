// Paths of numbered files, as a user writes them: out_%04d.png. Only the file's name has a place for the number: a
// percent sign in a folder, or one in the name that begins no place, is a percent sign.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/error.h"

namespace neuvv {

class NumberedPath {
  public:
    // Nothing where the file's name has no place for a number, %d or %0Nd with N of 1 to 9. Of several, the last
    // counts.
    static std::optional<NumberedPath> parse(const std::string& text);
    // The same for files that are to be written. Throws InputError for names that are probably mistakes: several
    // places, a place with another width as %4d, or one in the name of a folder that is not there. `output` is for the
    // error.
    static std::optional<NumberedPath> parse_output(const Subject& output, const std::string& text);

    std::string file(uint64_t number) const { return file(digits(number)); }
    // The path with this text in place of the number.
    std::string file(const std::string& in_place_of_number) const { return before_ + in_place_of_number + after_; }
    std::string digits(uint64_t number) const;
    const std::string& before() const { return before_; }  // the path up to the number

  private:
    std::string before_, after_;
    int digits_ = 1;  // at least so many
};

}  // namespace neuvv
