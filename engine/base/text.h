// What users write as lists.
#pragma once

#include <string>
#include <vector>

namespace neuvv {

// The parts between `at`, less the spaces around each: at least one, which may be empty.
std::vector<std::string> split(const std::string& text, char at);

}  // namespace neuvv
