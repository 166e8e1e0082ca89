// Clip files: brings the files of clips from the disk to the device, at once or ahead of time on threads of its own:
// one for all but what comes from servers, and stream::frames_at_once() that read only clips that play by frame,
// several frames at the same time, so that no file waits for a server.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/file_stamp.h"
#include "render/clips/frame_pace.h"
#include "render/clips/segment_paint.h"
#include "render/clips/uploaded_segment.h"

namespace neuvv::render {

// A clip's file on the device; of a segmented clip, that of a segment.
struct LoadedClip : UploadedSegment {
    std::filesystem::path path;
    FileStamp stamp;
};

// All functions may be called from any thread.
class ClipFiles {
  public:
    // The device must outlive this and all that it reads.
    explicit ClipFiles(const gpu::Device& device, SolidParts solid = SolidParts::kNo)
        : device_(device), solid_(solid) {}
    // Waits for the files that are being read, but not for servers.
    ~ClipFiles();
    ClipFiles(const ClipFiles&) = delete;
    ClipFiles& operator=(const ClipFiles&) = delete;

    // The segment, if it is on the device and in use, also as a part of another clip, and its file has not changed
    // since; else null. A clip that is one file is a segment, too.
    std::shared_ptr<const LoadedClip> find(const voctree::ClipSegment& segment);
    // Of a frame of a stream, the parts of it that came in time, where these are on the device and in use; else null.
    std::shared_ptr<const LoadedClip> find_parts(const voctree::ClipSegment& segment);
    // The same as find(), read now where it is not there. Where the device has no memory, it waits up to a second for
    // the files that others are reading, and tries once more. Throws InputError where upload_segment does,
    // RuntimeFailure where there still is no memory.
    std::shared_ptr<const LoadedClip> read(const voctree::ClipSegment& segment);

    // The paint of a segment that is on the device, for each of these lists of layers. What was read before is read
    // again only where it is not in use any more or its files have changed. Throws RuntimeFailure where the device has
    // no memory.
    using Paints = std::vector<std::shared_ptr<const SegmentPaint>>;
    Paints read_paints(const voctree::ClipSegment& segment, const LoadedClip& clip,
                       const std::vector<LayerFolders>& layers);

    struct Wanted {
        voctree::ClipSegment segment;
        bool is_urgent = false;              // its coarse tree is read first, where the file has one
        std::vector<LayerFolders> layers{};  // of which the paint is read, too
        bool in_time = false;                // of a frame of a stream: what comes in time is enough (FramePace)
    };
    // Has these segments read on the threads, in this order. They replace those of earlier calls that are not being
    // read yet. Where the device has no memory for one, the thread leaves it out and pauses for a second.
    void read_ahead(std::vector<Wanted> wanted);
    // The pace of the stream of which the segment is a frame; what is wanted in time follows it.
    std::shared_ptr<FramePace> pace_of(const voctree::ClipSegment& segment);

    // A segment that a thread has read, or what says why it could not.
    struct Result {
        std::filesystem::path file;
        FileStamp stamp;
        std::shared_ptr<const LoadedClip> clip;
        Note problem;
        bool is_coarse = false;  // this is its coarse tree; or of a frame of a stream, what came in time
        Paints paints{};         // for the lists of layers that were wanted; none of a coarse tree
        bool may_come = false;   // it could not be read because a server does not answer, or for want of memory
        bool lacks_memory = false;
    };
    // The results since the last call. Until then, they keep what was read on the device.
    std::vector<Result> take_results();

  private:
    std::shared_ptr<const SegmentPaint> read_paint(const voctree::ClipSegment& segment, const LoadedClip& clip,
                                                   const LayerFolders& of_clip);
    std::shared_ptr<const LoadedClip> begin_reading(const voctree::ClipSegment& segment, const FileStamp& stamp);
    void end_reading(const voctree::ClipSegment& segment, const std::shared_ptr<const LoadedClip>& whole);
    std::shared_ptr<const LoadedClip> load(const voctree::ClipSegment& segment, const FileStamp& stamp,
                                           stream::Part last, std::optional<double> asked_s);
    std::shared_ptr<const LoadedClip> read_once(const voctree::ClipSegment& segment,
                                                std::optional<double> asked_s = {});
    bool wait_for_others();
    void read_coarse(const voctree::ClipSegment& segment);
    bool read_in_time(const voctree::ClipSegment& segment, double asked_s);
    void read_one_ahead(const Wanted& wanted, double asked_s);
    bool has_result(const voctree::ClipSegment& segment);
    void add_result(Result result);
    void pause();
    // The next that is wanted and nobody reads.
    std::deque<Wanted>::iterator next_locked(bool frames);
    void run(bool frames);
    const gpu::Device& device_;
    const SolidParts solid_;
    std::mutex mutex_;  // guards all that follows
    std::condition_variable changed_;
    using Known = std::vector<std::weak_ptr<const LoadedClip>>;
    static std::shared_ptr<const LoadedClip> find_in(const Known& known, const std::filesystem::path& path,
                                                     const FileStamp& stamp);
    Known known_, known_parts_;  // all that are in use
    struct KnownPaint {
        std::filesystem::path segment;
        FileStamp stamp;  // of the segment
        std::weak_ptr<const SegmentPaint> paint;
    };
    std::vector<KnownPaint> known_paints_;  // all that are in use
    std::deque<Wanted> wanted_;
    double wanted_s_ = 0;                                                // seconds_now() at which they were
    std::map<std::filesystem::path, std::shared_ptr<FramePace>> paces_;  // by stream
    std::map<std::filesystem::path, std::shared_ptr<const voctree::ClipSource>> being_read_;
    std::vector<Result> results_;
    bool stop_ = false;
    std::vector<std::thread> threads_;  // begin with the first that is wanted
};

}  // namespace neuvv::render
