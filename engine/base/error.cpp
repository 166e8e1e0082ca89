#include "base/error.h"

namespace neuvv {

namespace {
// Errors are one line: text from hostile files may hold control characters, and they must not reach a terminal.
std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}
}  // namespace

InputError::InputError(const std::string& file, const std::string& place, const std::string& problem,
                       const std::string& mend)
    : std::runtime_error(
          one_line(file + ": " + (place.empty() ? "" : place + ": ") + problem + (mend.empty() ? "" : "; " + mend))) {}

}  // namespace neuvv
