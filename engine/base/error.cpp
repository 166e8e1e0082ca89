#include "base/error.h"

#include "base/text.h"

namespace neuvv {

namespace {
// The text on one line. Text from hostile files may contain control characters, which must not reach a terminal.
std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

std::string and_fix(const std::string& cause, const std::string& fix) {
    return fix.empty() ? cause : cause + "; " + fix;
}
}  // namespace

// Without passwords before it is cut, where an address might lose its '@'.
std::string shortened(const std::string& given) {
    constexpr size_t kLongest = 450, kEnd = 100;
    const std::string text = without_passwords(given);
    if (text.size() <= kLongest) return one_line(text);
    return one_line(text.substr(0, kLongest - kEnd) + " ... " + text.substr(text.size() - kEnd));
}

Failure::Failure(const std::string& cause, const Fix& fix, bool about_setting)
    : std::runtime_error(and_fix(cause, shortened(plain_words(fix)))),
      cause_(cause),
      fix_(fix),
      about_setting_(about_setting) {}

InputError::InputError(const Subject& subject, const std::string& place, const std::string& problem, const Fix& fix)
    : Failure(shortened(subject.name) + ": " + (place.empty() ? "" : shortened(place) + ": ") + shortened(problem), fix,
              subject.is_setting) {}

Note::Note(const std::exception& error) : text(error.what()) {
    const auto* failure = dynamic_cast<const Failure*>(&error);
    if (failure == nullptr) return;
    text = failure->cause();
    fix = failure->fix();
}

std::string Note::words() const {
    return and_fix(text, plain_words(fix));
}

}  // namespace neuvv
