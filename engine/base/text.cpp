#include "base/text.h"

#include <cctype>

#include <algorithm>
#include <string_view>

namespace neuvv {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (size_t begin = 0; begin <= text.size();) {
        const size_t end = std::min(text.find(separator, begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        const size_t first = part.find_first_not_of(' ');
        parts.push_back(first == std::string::npos ? "" : part.substr(first, part.find_last_not_of(' ') + 1 - first));
        begin = end + 1;
    }
    return parts;
}

bool is_utf8(std::string_view bytes) {
    constexpr uint32_t kLeast[] = {0, 0x80, 0x800, 0x10000};  // what so many more bytes must at least say
    for (size_t i = 0; i < bytes.size(); ++i) {
        const auto first = static_cast<uint8_t>(bytes[i]);
        if (first < 0x80) continue;
        const size_t more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
        if (first < 0xc2 || first > 0xf4 || i + more >= bytes.size()) return false;
        uint32_t letter = first & (0x3fu >> more);
        for (size_t k = 0; k < more; ++k) {
            const auto next = static_cast<uint8_t>(bytes[++i]);
            if ((next & 0xc0) != 0x80) return false;
            letter = letter << 6 | (next & 0x3fu);
        }
        if (letter < kLeast[more] || letter > 0x10ffff || (letter >= 0xd800 && letter < 0xe000)) return false;
    }
    return true;
}

// A '/' in a password would have to be written %2F; where it is not, what is before the '/' is no port.
std::string without_passwords(std::string text) {
    constexpr const char* kEndsAddress = " \t\r\n\"'<>`";
    for (size_t at = text.find("://"); at != std::string::npos; at = text.find("://", at)) {
        at += 3;
        const size_t end = std::min(text.find_first_of(kEndsAddress, at), text.size());
        size_t host_end = std::min(text.find_first_of("/?#\\", at), end);
        const size_t colon = std::min(text.find(':', at), host_end);
        const bool is_v6 = text.compare(at, 1, "[") == 0;
        const bool is_port =
            is_v6 || text.substr(colon, host_end - colon).find_first_not_of(":0123456789") == std::string::npos;
        if (!is_port) host_end = end;
        const std::string_view head = std::string_view(text).substr(at, host_end - at);
        if (const size_t sign = head.rfind('@'); sign != std::string_view::npos) text.replace(at, sign, "***");
    }
    return text;
}

std::string base64(std::span<const uint8_t> bytes) {
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t left = std::min<size_t>(bytes.size() - i, 3);
        uint32_t group = 0;
        for (size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; ++k) text += k <= left ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string lower_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

}  // namespace neuvv
