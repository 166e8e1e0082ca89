#include "motion/skeleton/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/platform.h"
#include "base/text.h"

namespace neuvv::motion {

namespace {

constexpr uint64_t kMaxText_bytes = uint64_t{1} << 30;
constexpr size_t kLongestLine = 1 << 20;

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

}  // namespace

Words::Words(const std::filesystem::path& file) : file_(file.string()) {
    const std::vector<uint8_t> bytes = read_file(file, kMaxText_bytes);
    text_.assign(bytes.begin(), bytes.end());
    if (text_.starts_with("\xff\xfe") || text_.starts_with("\xfe\xff"))
        fail("is a text of UTF-16", "save it as UTF-8 or ASCII");
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // a byte order mark
}

void Words::fail(const std::string& problem, const std::string& fix) const {
    throw InputError(file_, fmt::format("line {}", line_), problem, fix);
}

std::string Words::next() {
    line_ += std::exchange(line_ended_, false);
    while (at_ < text_.size() && is_space(text_[at_])) line_ += text_[at_++] == '\n';
    const size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    if (begin == at_) fail("the file ends too early", "write it again");
    return text_.substr(begin, at_ - begin);
}

void Words::expect(const char* word) {
    const std::string found = next();
    if (lower_case(found) != lower_case(word))
        fail(fmt::format("\"{}\" stands where {} should", found.substr(0, 40), word));
}

double Words::number(double low, double high) {
    const std::string word = next();
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(value >= low && value <= high))
        fail(fmt::format("\"{}\" is no number from {} to {}", word.substr(0, 40), low, high));
    return value;
}

bool Words::line(std::string& text) {
    line_ += std::exchange(line_ended_, false);
    if (at_ >= text_.size()) return false;
    const size_t end = std::min(text_.find('\n', at_), text_.size());
    if (end - at_ > kLongestLine) fail("has a line of more than a megabyte", "write it again");
    text = text_.substr(at_, end - at_);
    while (!text.empty() && text.back() == '\r') text.pop_back();
    line_ended_ = end < text_.size();
    at_ = std::min(end + 1, text_.size());
    return true;
}

}  // namespace neuvv::motion
