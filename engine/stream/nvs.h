// The .nvs file: a clip as slices, compressed, that can be played from any of its groups of frames on, and whose index
// stands at the front. engine/stream/README.md specifies the bytes.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "stream/byte_source.h"
#include "stream/frame_codec.h"

namespace neuvv::stream {

// A run of frames that is decoded without any others.
struct Group {
    uint32_t first = 0, frames = 0;
    Format format;
    std::array<float, 3> box_min{}, box_size{1, 1, 1};  // metres
    uint64_t offset = 0;                                // of its tables in the file; its frames follow
    uint32_t table_bytes = 0, table_check = 0;          // as they are stored, deflated
};

struct FrameEntry {
    std::array<uint32_t, kParts> ends{};    // of its parts, from its beginning
    std::array<uint32_t, kParts> checks{};  // CRC-32 of each part
};

struct Index {
    float fps = 25;
    std::vector<Group> groups;       // in order, without gaps
    std::vector<FrameEntry> frames;  // of the whole clip
    uint32_t group_of(uint32_t frame) const;
    uint64_t offset_of(uint32_t frame) const;  // in the file
};

constexpr uint32_t kMaxStreamFrames = 10'000'000;
constexpr uint32_t kMaxGroupFrames = 1000;
constexpr uint32_t kMaxStreamLeaves = 1u << 24;  // of a frame

// Whether a file begins as a .nvs does, false where it cannot be read; or whether the path is an address, which nothing
// else is taken from.
bool is_stream(const std::filesystem::path& path);

// A stream that is open. All functions may be called from any thread. All throw InputError with file, place and fix for
// what is damaged, ServerProblem where a server does not answer.
class Reader {
  public:
    // `path` may be an address.
    explicit Reader(const std::filesystem::path& path);

    const Index& index() const { return index_; }
    const std::filesystem::path& path() const { return path_; }
    const FileStamp& stamp() const { return source_->stamp(); }  // when it was opened
    // Whether it was found to be damaged or to have changed: then it should be opened again.
    bool has_failed() const { return failed_; }
    // Ends what waits for a server, in all threads and from now on (ServerProblem).
    void cancel();

    // The frame, decoded from its first parts. Frames that were read last are kept, kKept of them; a frame behind one
    // of these in the same group is decoded from there on, others from the beginning of their group.
    static constexpr size_t kKept = 16;
    // From a server, the bytes of the frames of so many seconds behind it are fetched meanwhile, 32 MiB at most.
    static constexpr float kAhead_s = 3;
    std::shared_ptr<const Slice> frame(uint32_t frame, Part last = kShFine);

  private:
    std::vector<uint8_t> bytes_at(uint64_t offset, uint64_t count, const std::string& place);
    struct Kept {
        uint32_t frame;
        Part last;
        std::shared_ptr<const Slice> slice;
    };
    void read_ahead(uint32_t frame);
    std::shared_ptr<const Slice> decode_next(uint32_t frame, Part last, const Slice* before);
    [[noreturn]] void fail(const std::string& place, const std::string& problem) const;
    std::filesystem::path path_;
    std::unique_ptr<ByteSource> source_;  // by one thread at a time
    Index index_;
    mutable std::atomic<bool> failed_ = false;
    std::mutex mutex_;  // guards what follows, and reading
    std::optional<uint32_t> table_group_;
    Tables tables_;
    std::vector<Kept> kept_;  // the one that was decoded last at the end
};

// Bytes of the head of a stream.
uint64_t head_bytes(uint64_t groups, uint64_t frames);

// Writes a stream: what is before the frames is written at the end, when it is known.
class Writer {
  public:
    // The file appears, atomically, with finish(). `frames` and `groups` must be those that are added. Throws
    // RuntimeFailure where the disk fails, as all functions do.
    Writer(const std::filesystem::path& path, float fps, uint32_t frames, uint32_t groups);
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    // Adds the next group: its frames in order, encoded as one group. The group's `first`, `offset` and tables are set
    // here. Returns their bytes, those in the index included.
    uint64_t add(Group group, const std::vector<FrameSymbols>& frames);
    // Returns the number of bytes.
    uint64_t finish();

  private:
    void write(const std::vector<uint8_t>& bytes);
    void remove_unfinished();
    std::filesystem::path path_, temporary_;
    std::FILE* file_ = nullptr;
    Index index_;
    uint64_t next_ = 0;  // offset
};

// The bytes of a group's frames: its tables, deflated, and its frames.
struct GroupBytes {
    std::vector<uint8_t> tables;
    std::vector<FrameBytes> frames;
    uint64_t count() const;
};
GroupBytes bytes_of(const std::vector<FrameSymbols>& frames);

}  // namespace neuvv::stream
