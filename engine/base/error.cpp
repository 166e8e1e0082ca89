#include "base/error.h"

namespace neuvv {

namespace {
// The text on one line. Text from hostile files may contain control characters, which must not reach a terminal.
std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

std::string shortened(const std::string& text) {
    constexpr size_t kLongest = 450, kEnd = 100;
    if (text.size() <= kLongest) return text;
    return text.substr(0, kLongest - kEnd) + " ... " + text.substr(text.size() - kEnd);
}
}  // namespace

InputError::InputError(const std::string& file, const std::string& place, const std::string& problem,
                       const std::string& fix)
    : std::runtime_error(one_line(shortened(file) + ": " + (place.empty() ? "" : shortened(place) + ": ") +
                                  shortened(problem) + (fix.empty() ? "" : "; " + shortened(fix)))) {}

}  // namespace neuvv
