#include "base/error.h"

#include "base/text.h"

namespace neuvv {

namespace {
// The text on one line. Text from hostile files may contain control characters, which must not reach a terminal.
std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

// Without passwords before it is cut, where an address might lose its '@'.
std::string shortened(const std::string& given) {
    constexpr size_t kLongest = 450, kEnd = 100;
    const std::string text = without_passwords(given);
    if (text.size() <= kLongest) return text;
    return text.substr(0, kLongest - kEnd) + " ... " + text.substr(text.size() - kEnd);
}
}  // namespace

InputError::InputError(const std::string& file, const std::string& place, const std::string& problem,
                       const std::string& fix)
    : std::runtime_error(one_line(shortened(file) + ": " + (place.empty() ? "" : shortened(place) + ": ") +
                                  shortened(problem) + (fix.empty() ? "" : "; " + shortened(fix)))) {}

}  // namespace neuvv
