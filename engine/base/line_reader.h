// Lines of text that come from another program.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace neuvv {

constexpr int kStandardInput = 0;  // its descriptor

class LineReader {
  public:
    enum class Result { kLine, kNothing, kEnd };

    // Reads a descriptor, which stays open; of lines longer than `longest` bytes, no more than longest + 1 are kept.
    LineReader(int descriptor, size_t longest);
    // Reads a file. Throws InputError where it cannot be opened.
    LineReader(const std::filesystem::path& file, size_t longest);
    ~LineReader();
    LineReader(const LineReader&) = delete;
    LineReader& operator=(const LineReader&) = delete;

    // The next line, without its end; nothing where none is complete after `wait_ms` milliseconds, after a signal, and
    // after each 64 KiB of a line that does not end. It takes at most one such piece from the system.
    Result next(std::string& line, int wait_ms = 0);

  private:
    bool take_line(std::string& line);

    int descriptor_ = -1;
    bool owned_ = false, ended_ = false;
    size_t longest_;
    std::vector<char> buffer_;
    size_t begin_ = 0, end_ = 0;  // what of the buffer has not been taken yet
    std::string line_;            // the beginning of the next line
};

}  // namespace neuvv
