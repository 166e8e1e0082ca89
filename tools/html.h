// What the HTML pages that this program writes have alike.
#pragma once

#include <string>

namespace neuvv::tools {

// The beginning of a page, up to its title. The page may load and run only what it contains itself.
extern const char* const kHtmlHead;

// Text as HTML: <, >, &, " and ' as entities, control characters as spaces.
std::string html_text(const std::string& text);

}  // namespace neuvv::tools
