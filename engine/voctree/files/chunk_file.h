// The container of .nvv and .nvpaint files: a magic, a version, then named, checksummed, compressed chunks up to END.
// What the chunks mean is defined in nvv.cpp and nvpaint.cpp, and the byte layout in README.md beside this file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "base/platform.h"
#include "base/remedy.h"

namespace neuvv::voctree {

constexpr uint32_t kNvvVersion = 3;

struct ChunkHeader {
    std::string name;           // four ASCII letters or digits, or "END "
    uint64_t raw_bytes = 0;     // of the content
    uint64_t stored_bytes = 0;  // of the compressed content
    uint64_t checksum = 0;
};

// Whether `name` has four ASCII letters or digits, the first a letter.
bool is_chunk_name(const std::string& name);
// Whether the first letter is lower-case, so that a reader that does not know the chunk may ignore it.
bool is_ancillary(const std::string& chunk_name);

// Writes a container to `sink` in one pass. Throws RuntimeFailure where a reader would refuse the result. `path` is for
// error messages, `compression` is zstd's level.
class ChunkWriter {
  public:
    ChunkWriter(std::string path, const ByteSink& sink, int compression);
    void add(const std::string& name, const void* data, size_t bytes);
    // Counts memory that readers will need besides the chunks' content; readers limit the sum of both.
    void claim(uint64_t bytes) { raw_bytes_ += bytes; }
    void finish();

  private:
    void write(const void* data, size_t bytes);
    void write_chunk(const std::string& name, uint64_t raw_bytes, const void* stored, size_t stored_bytes);

    std::string path_;  // for errors
    const ByteSink& sink_;
    int compression_;
    uint64_t previous_checksum_ = 0;
    uint64_t file_bytes_ = 0, raw_bytes_ = 0;
    std::vector<std::string> names_;
};

// What a file contains as its first bytes say, so that an error message can name a file of the wrong kind.
enum class FileContent { kOther, kClip, kPaint };
FileContent content_of(std::span<const uint8_t> first_bytes);  // the first 16 bytes suffice
FileContent content_of(const std::filesystem::path& path);     // kOther where the file cannot be read

// How error messages describe a kind of file: its ending, and what to do where a file is another.
struct FileKind {
    std::string ending = ".nvv";
    Remedy fix = Remedy::kNameClip;
};

// Reads a container from front to back, with one chunk in memory at a time. Methods throw InputError where the file is
// damaged or exceeds the limits of the format.
class ChunkReader {
  public:
    explicit ChunkReader(const std::filesystem::path& path, const FileKind& kind = {});

    // Opens the next chunk, which must then be taken or skipped. Returns false at END, when the file is known to be
    // complete.
    bool next(ChunkHeader& header);
    // The open chunk's content, whose checksum is verified. It must be `raw_bytes` long.
    std::vector<uint8_t> take(uint64_t raw_bytes);
    // Counts memory that must be allocated for the open chunk besides its content, so that the file cannot demand more
    // than its size permits.
    void claim(uint64_t bytes);
    // Skips the open chunk. Its checksum is verified only if `verify`.
    void skip(bool verify);

    uint64_t file_bytes() const { return file_bytes_; }
    const std::string& path() const { return path_; }
    // Both throw InputError that names the open chunk.
    [[noreturn]] void fail(const std::string& problem, const std::string& fix) const;
    [[noreturn]] void fail_damaged(const std::string& problem) const;

  private:
    void read(void* data, size_t bytes);

    std::string path_;
    std::ifstream file_;
    uint64_t file_bytes_ = 0, position_ = 0, raw_total_ = 0;
    uint64_t previous_checksum_ = 0;
    ChunkHeader open_;
    std::vector<std::string> names_;
};

}  // namespace neuvv::voctree
