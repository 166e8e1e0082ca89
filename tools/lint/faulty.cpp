// What tools/check tidy must complain of, so that a linter that looks at nothing is noticed. Nothing compiles it.
#include <string>
#include <utility>

std::string::size_type use_after_move(std::string text) {
    const std::string taken = std::move(text);
    return taken.size() + text.size();
}
