#include "base/numbered_path.h"

#include <fmt/format.h>

#include <cctype>

namespace neuvv {

std::optional<NumberedPath> NumberedPath::parse(const std::string& text) {
    const size_t percent = text.rfind('%');
    if (percent == std::string::npos) return {};
    NumberedPath path;
    size_t end = percent + 1;
    if (end + 1 < text.size() && text[end] == '0') {
        if (std::isdigit(static_cast<unsigned char>(text[end + 1])) == 0) return {};
        path.digits_ = text[end + 1] - '0';
        end += 2;
    }
    if (end >= text.size() || text[end] != 'd' || path.digits_ < 1) return {};
    path.before_ = text.substr(0, percent);
    path.after_ = text.substr(end + 1);
    return path;
}

std::string NumberedPath::file(uint64_t number) const {
    return file(fmt::format("{:0{}}", number, digits_));
}

}  // namespace neuvv
