// Where the bytes of a stream come from: a file, or a server by HTTP ranges.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file_stamp.h"

namespace neuvv::stream {

struct ByteRange {
    uint64_t offset = 0, count = 0;
    uint64_t end() const { return offset + count; }
};

// A server that does not answer now, but may later.
class ServerProblem : public InputError {
  public:
    using InputError::InputError;
};

// Any thread may call its functions; who reads what is here does not wait for who reads what has to come.
class ByteSource {
  public:
    virtual ~ByteSource() = default;
    uint64_t size() const { return stamp_.bytes; }
    const FileStamp& stamp() const { return stamp_; }  // when it was opened; of a server, its size alone
    // Throws InputError where they cannot be read, ServerProblem where that may pass. They must lie within the size.
    virtual std::vector<uint8_t> read(uint64_t offset, uint64_t count) = 0;
    // Says what will be read next, the first first, so that it may be fetched meanwhile, in place of what was said
    // before.
    virtual void read_ahead(const std::vector<ByteRange>& /*ranges*/) {}
    // How fast bytes come from a server, 0 where nobody knows yet; nothing where they are here.
    virtual std::optional<double> bytes_per_s() const { return std::nullopt; }
    // What was read is damaged: it is not to be read again from where copies of it are kept.
    virtual void forget_copies() {}
    // At any time: what waits for a server ends with ServerProblem, now and later.
    virtual void cancel() {}

  protected:
    FileStamp stamp_;
};

// Whether a path is an address, http:// or https://.
bool is_address(const std::filesystem::path& path);

// Throws InputError where there is no such file, or the server does not answer, or not with a range of it.
std::unique_ptr<ByteSource> open_source(const std::filesystem::path& path);

}  // namespace neuvv::stream
