#include "base/line_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace neuvv {

namespace {

constexpr size_t kPiece_bytes = 1 << 16;

}  // namespace

LineReader::LineReader(int descriptor, size_t longest)
    : descriptor_(descriptor), longest_(longest), buffer_(kPiece_bytes) {}

LineReader::LineReader(const std::filesystem::path& file, size_t longest)
    : LineReader(open(file.c_str(), O_RDONLY | O_CLOEXEC), longest) {
    if (descriptor_ < 0)
        throw InputError(file.string(), "", fmt::format("cannot be read: {}", std::strerror(errno)), "check the path");
    owned_ = true;
}

LineReader::~LineReader() {
    if (owned_) close(descriptor_);
}

// Moves the buffer's bytes up to the next line break to the line. Returns whether the line is complete.
bool LineReader::take_line(std::string& line) {
    const char* begin = buffer_.data() + begin_;
    const char* end = buffer_.data() + end_;
    const char* line_break = std::find(begin, end, '\n');
    const auto bytes = static_cast<size_t>(line_break - begin);
    line_.append(begin, std::min(bytes, longest_ + 1 - line_.size()));
    begin_ = line_break == end ? end_ : begin_ + bytes + 1;
    if (line_break == end) return false;
    line.swap(line_);
    line_.clear();
    return true;
}

LineReader::Result LineReader::next(std::string& line, int wait_ms) {
    if (take_line(line)) return Result::kLine;
    if (!ended_) {
        pollfd ready{descriptor_, POLLIN, 0};
        if (poll(&ready, 1, wait_ms) <= 0) return Result::kNothing;
        const ssize_t bytes = read(descriptor_, buffer_.data(), buffer_.size());
        if (bytes < 0 && (errno == EINTR || errno == EAGAIN)) return Result::kNothing;
        ended_ = bytes <= 0;
        begin_ = 0;
        end_ = ended_ ? 0 : static_cast<size_t>(bytes);
        if (take_line(line)) return Result::kLine;
        if (!ended_) return Result::kNothing;
    }
    if (line_.empty()) return Result::kEnd;
    line.swap(line_);
    line_.clear();
    return Result::kLine;
}

}  // namespace neuvv
