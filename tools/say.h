// What the program says beside its results.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

#include "base/text.h"

namespace neuvv::tools {

// Writes to stderr, with no line feed added. Nothing is thrown where that fails, as on a full disk: a remark that
// nobody can read is no reason to end a training.
template <typename... Arguments>
void say(fmt::format_string<Arguments...> format, Arguments&&... arguments) noexcept {
    try {
        const std::string text = without_passwords(fmt::format(format, std::forward<Arguments>(arguments)...));
        std::fwrite(text.data(), 1, text.size(), stderr);
    } catch (...) {  // no memory for the text
    }
}

}  // namespace neuvv::tools
