// Text in and out: lists as users write them, and bytes as text.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace neuvv {

// The parts between `at`, less the spaces around each: at least one, which may be empty.
std::vector<std::string> split(const std::string& text, char separator);

// Bytes as data URIs hold them, padded with '='.
std::string base64(std::span<const uint8_t> bytes);

}  // namespace neuvv
