// What the program prints: results to stdout, and what it says beside them to stderr.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>

#include "base/text.h"

namespace neuvv::tools {

// The text without passwords, and with spaces for control characters, by which a name in a hostile file could command
// the terminal. Line feeds and tabs stay, and a carriage return at the beginning.
inline std::string text_for_terminal(std::string text) {
    text = without_passwords(std::move(text));
    for (size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<uint8_t>(text[i]);
        const bool stays = byte == '\n' || byte == '\t' || (byte == '\r' && i == 0);
        if ((byte < 0x20 && !stays) || byte == 0x7f) text[i] = ' ';
        // U+0080 to U+009F are control characters, too; in UTF-8 they are two bytes.
        if (i > 0 && static_cast<uint8_t>(text[i - 1]) == 0xc2 && byte >= 0x80 && byte < 0xa0)
            text[i - 1] = text[i] = ' ';
    }
    return text;
}

// Writes to stdout, with no line feed added. Throws std::system_error where that fails.
template <typename... Arguments>
void tell(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::print("{}", text_for_terminal(fmt::format(format, std::forward<Arguments>(arguments)...)));
}

// The same where a failure must not end what goes on, such as a training. Program::run sees it at the end.
template <typename... Arguments>
void tell_if_possible(fmt::format_string<Arguments...> format, Arguments&&... arguments) noexcept {
    try {
        tell(format, std::forward<Arguments>(arguments)...);
    } catch (...) {  // the stream keeps the failure
    }
}

// Writes to stderr, with no line feed added. Nothing is thrown where that fails, as on a full disk: a remark that
// nobody can read is no reason to end a training.
template <typename... Arguments>
void say(fmt::format_string<Arguments...> format, Arguments&&... arguments) noexcept {
    try {
        const std::string text = text_for_terminal(fmt::format(format, std::forward<Arguments>(arguments)...));
        std::fwrite(text.data(), 1, text.size(), stderr);
    } catch (...) {  // no memory for the text
    }
}

}  // namespace neuvv::tools
