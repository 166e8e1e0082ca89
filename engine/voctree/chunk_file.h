// The container of .nvv and .nvpaint: a magic, a version, then named, checksummed, compressed chunks up to END. What
// the chunks mean is the business of nvv.cpp and nvpaint.cpp. Byte layout: README.md beside this file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "base/platform.h"

namespace neuvv::voctree {

constexpr uint32_t kNvvVersion = 3;

struct ChunkHeader {
    std::string name;  // four ASCII letters or digits, or "END "
    uint64_t raw_bytes = 0;
    uint64_t stored_bytes = 0;
    uint64_t checksum = 0;
};

// Four ASCII letters or digits, the first a letter.
bool is_chunk_name(const std::string& name);
// Lower-case first letter: a reader that does not know the chunk may ignore it.
bool is_ancillary(const std::string& chunk_name);

// Writes a container into `sink` in one pass. Throws RuntimeFailure where a reader would refuse the result.
class ChunkWriter {
  public:
    ChunkWriter(std::string path, const ByteSink& sink, int compression);
    void add(const std::string& name, const void* data, size_t bytes);
    // Counts memory that readers will need beyond the chunks' content.
    void claim(uint64_t bytes) { raw_bytes_ += bytes; }
    void finish();

  private:
    void put(const void* data, size_t bytes);
    void put_chunk(const std::string& name, uint64_t raw_bytes, const void* stored, size_t stored_bytes);

    std::string path_;  // for errors
    const ByteSink& sink_;
    int compression_;
    uint64_t previous_checksum_ = 0;
    uint64_t file_bytes_ = 0, raw_bytes_ = 0;
    std::vector<std::string> names_;
};

// What our files begin with, for those who were given the wrong one.
enum class FileContent { kOther, kClip, kPaint };
FileContent content_of(std::span<const uint8_t> first_bytes);  // 16 of them tell
FileContent content_of(const std::filesystem::path& path);     // kOther where it cannot be read

// What a file of ours is called in errors, and who writes such.
struct FileKind {
    std::string ending = ".nvv", writer = "neuvv train";
};

// Reads a container front to back, one chunk in memory at a time. Every method throws InputError.
class ChunkReader {
  public:
    explicit ChunkReader(const std::filesystem::path& path, const FileKind& kind = {});

    // Opens the next chunk; false at END, after which the file is known to be whole. Each chunk must be taken or
    // skipped.
    bool next(ChunkHeader& header);
    // The open chunk's content, checked against its checksum. `raw_bytes` is what the caller knows it must be.
    std::vector<uint8_t> take(uint64_t raw_bytes);
    // Counts memory that the open chunk's content asks for, as if it were content: a small file may not ask for much.
    void claim(uint64_t bytes);
    // Passes over the open chunk; with `verify` its checksum is checked.
    void skip(bool verify);

    uint64_t file_bytes() const { return file_bytes_; }
    const std::string& path() const { return path_; }
    [[noreturn]] void fail(const std::string& problem, const std::string& fix) const;  // at the open chunk
    [[noreturn]] void fail_damaged(const std::string& problem) const;

  private:
    void get(void* data, size_t bytes);

    std::string path_;
    std::ifstream file_;
    uint64_t file_bytes_ = 0, position_ = 0, raw_total_ = 0;
    uint64_t previous_checksum_ = 0;
    ChunkHeader open_;
    std::vector<std::string> names_;
};

}  // namespace neuvv::voctree
