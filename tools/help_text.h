// Text of the help that fits a terminal, and names that a user may have meant.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace neuvv::tools {

constexpr size_t kHelpColumns = 98;  // groups of options are indented by two more

// A name on the left, and its description beside it, or below where the name is long. The description begins at
// `column`.
std::string help_entry(const std::string& name, const std::string& description, size_t column);

// Paragraphs are filled anew. Indented lines are kept, and where they are too long continue below their last column, or
// behind a backslash where they are a command.
std::string filled(const std::string& text);

// The one of `names` that differs from `typed` by few letters; empty where none does.
std::string nearest_name(const std::string& typed, const std::vector<std::string>& names);

}  // namespace neuvv::tools
