// Reads .nvs files and addresses of them.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "stream/codec/frame_cost.h"
#include "stream/transport/byte_source.h"
#include "stream/transport/nvs_index.h"

namespace neuvv::stream {

// Whether a file begins as a .nvs does, false where it cannot be read; or whether the path is an address, which nothing
// else is taken from.
bool is_stream(const std::filesystem::path& path);

// How many frames players decode, and make ready to be drawn, at the same time: by half of the cores, because the
// others draw, but not by more than 8.
uint32_t frames_at_once();

// A stream that is open. All functions may be called from any thread; several threads decode several frames at the same
// time. All throw InputError with file, place and fix for what is damaged, ServerProblem where a server does not
// answer.
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

    // The frame, decoded from its first parts. Frames that were read last are kept: as many as take kKeptBytes, at most
    // kMostKept, and at least as many as threads decode and others repeat. Of the frames from the key frame on, or the
    // last that is kept, the shapes are decoded; the planes only where the frame repeats some. Threads read and decode
    // without waiting for each other unless their frames depend on the same key frame.
    static constexpr size_t kMostKept = 16;
    static constexpr uint64_t kKeptBytes = uint64_t{64} << 20;
    // From a server, the bytes of the frames of so many seconds behind it are fetched meanwhile.
    static constexpr double kAhead_s = 3;
    // `times` becomes what this call took to decode, without what it waited.
    std::shared_ptr<const QuantisedSlice> frame(uint32_t frame, Part last = kShFine, DecodeTimes* times = nullptr);

    // From a server, has the first frame fetched, which most players show first, while the caller gets ready.
    void read_first_ahead();

    GroupCost cost_of(uint32_t frame) const;  // of its group
    // As they come from a server; nothing where they are here.
    std::optional<double> bytes_per_s() const { return source_->bytes_per_s(); }

  private:
    // The tables of a group, which are read when a frame first needs them.
    struct GroupTables {
        std::mutex mutex;
        std::optional<Tables> tables;
    };
    // A frame that is being decoded: first its shape, for which that of the frame before must be known, then its
    // planes. Who holds a frame's mutexes locks those of the frame before, then that of the tables, never the other way
    // round.
    struct FrameInProgress {
        uint32_t frame = 0, group = 0;
        Part last = kShFine;
        std::shared_ptr<GroupTables> tables;
        std::mutex shape_mutex;           // guards `shape` until it is there
        std::optional<FrameShape> shape;  // nothing: it is not decoded yet
        // Guards `slice` and, once the shape is there, what the next frame does not need: the tree, and the leaves if
        // that is a key frame.
        std::mutex slice_mutex;
        std::shared_ptr<const QuantisedSlice> slice;  // null: its planes are not decoded yet
        // The frame before, as long as it may be needed; null of a key frame. Guarded by shape_mutex until the shape
        // is there, then by slice_mutex.
        std::shared_ptr<FrameInProgress> before;
    };
    std::vector<uint8_t> bytes_at(const ByteRange& range, const std::string& place);
    std::vector<ByteRange> parts_of(uint32_t frame, Part last) const;
    std::vector<uint8_t> part_of(uint32_t frame, Part part);
    const Tables& tables_of(const FrameInProgress& begun);
    void read_ahead(uint32_t frame, Part last);
    size_t kept_of(uint32_t group) const;
    std::shared_ptr<FrameInProgress> begin_next_locked(uint32_t frame, Part last,
                                                       const std::shared_ptr<FrameInProgress>& before);
    std::shared_ptr<FrameInProgress> begin_towards(uint32_t frame, Part last, std::shared_ptr<FrameInProgress> known);
    const FrameShape& shape_of(FrameInProgress& begun, DecodeTimes& times);
    void forget(uint32_t frame);
    std::shared_ptr<const QuantisedSlice> slice_of(FrameInProgress& begun, DecodeTimes& times);
    [[noreturn]] void fail(const std::string& place, const std::string& problem) const;
    std::filesystem::path path_;
    std::unique_ptr<ByteSource> source_;
    Index index_;
    mutable std::atomic<bool> failed_ = false;
    std::mutex mutex_;                                    // guards what follows; nobody reads while they hold it
    std::vector<std::shared_ptr<FrameInProgress>> kept_;  // the one that was begun last at the end
};

}  // namespace neuvv::stream
