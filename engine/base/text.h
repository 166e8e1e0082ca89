// Text as users write it, and bytes as text.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace neuvv {

// The parts of the text between separators, without spaces around them. There is at least one part; parts may be empty.
std::vector<std::string> split(const std::string& text, char separator);

// The text with ASCII letters in lower case.
std::string lower_case(std::string text);

// Whether the bytes are UTF-8, as JSON must be. Names of files may be any bytes.
bool is_utf8(std::string_view bytes);

// The text with the passwords of its addresses hidden: "https://eva:secret@host/" becomes "https://***@host/".
std::string without_passwords(std::string text);

// The bytes in base64 as in data URIs, padded with '='.
std::string base64(std::span<const uint8_t> bytes);

}  // namespace neuvv
