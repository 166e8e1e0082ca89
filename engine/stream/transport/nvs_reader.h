// Reads .nvs files and addresses of them.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "stream/transport/byte_source.h"
#include "stream/transport/ladder.h"
#include "stream/transport/nvs_index.h"

namespace neuvv::stream {

// Whether a file begins as a .nvs does, false where it cannot be read; or whether the path is an address, which nothing
// else is taken from.
bool is_stream(const std::filesystem::path& path);

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
    static constexpr uint64_t kKeptBytes = uint64_t{256} << 20;
    // From a server, the bytes of the frames of so many seconds behind it are fetched meanwhile.
    static constexpr double kAhead_s = 3;
    std::shared_ptr<const QuantisedSlice> frame(uint32_t frame, Part last = kShFine);

    // The last part of a frame that comes in time while the stream is played at its own speed. It is the same for all
    // frames of a group for so many seconds and twice the group's length; then it is chosen anew.
    static constexpr double kLeastChoice_s = 1;
    Part part_in_time(uint32_t frame);
    // What it took to bring a decoded frame to the device, by which part_in_time() chooses, too.
    void learn_upload(double seconds) { ladder_.learn_step(FrameStep::kUpload, seconds); }

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
        std::mutex shape_mutex;                       // guards `shape`, of which only the tree changes once it is there
        std::optional<FrameShape> shape;              // nothing: it is not decoded yet
        std::mutex slice_mutex;                       // guards `slice` and, once the shape is there, its tree
        std::shared_ptr<const QuantisedSlice> slice;  // null: its planes are not decoded yet
        // The frame before, as long as it may be needed; null of a key frame. Guarded by shape_mutex until the shape
        // is there, then by slice_mutex.
        std::shared_ptr<FrameInProgress> before;
    };
    std::vector<uint8_t> bytes_at(const ByteRange& range, const std::string& place);
    std::vector<uint8_t> part_of(uint32_t frame, Part part);
    const Tables& tables_of(const FrameInProgress& begun);
    void read_ahead(uint32_t frame, Part last);
    size_t kept_of(uint32_t group) const;
    std::shared_ptr<FrameInProgress> begin_next_locked(uint32_t frame, Part last,
                                                       const std::shared_ptr<FrameInProgress>& before);
    std::shared_ptr<FrameInProgress> begin_towards(uint32_t frame, Part last, std::shared_ptr<FrameInProgress> known);
    const FrameShape& shape_of(FrameInProgress& begun);
    void forget(uint32_t frame);
    std::shared_ptr<const QuantisedSlice> slice_of(FrameInProgress& begun);
    [[noreturn]] void fail(const std::string& place, const std::string& problem) const;
    std::filesystem::path path_;
    std::unique_ptr<ByteSource> source_;
    Index index_;
    mutable std::atomic<bool> failed_ = false;
    Ladder ladder_;
    std::mutex mutex_;                                    // guards what follows; nobody reads while they hold it
    std::vector<std::shared_ptr<FrameInProgress>> kept_;  // the one that was begun last at the end
    struct Chosen {
        uint32_t group = 0;
        Part last = kShFine;
        double until_s = 0;  // seconds_now()
    };
    std::vector<Chosen> chosen_;  // by part_in_time()
};

}  // namespace neuvv::stream
