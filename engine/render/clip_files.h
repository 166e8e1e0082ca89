// Clip files: brings the files of clips from the disk to the device, at once or ahead of time on a thread of its own.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/file_stamp.h"
#include "render/field_levels.h"
#include "voctree/clip_index.h"
#include "voctree/paint.h"

namespace neuvv::render {

// A clip's file on the device; of a segmented clip, that of a segment.
struct LoadedClip {
    std::filesystem::path path;
    FileStamp stamp;
    Field field;
    voctree::PaintedField painted;
};

class ClipFiles {
  public:
    // The device must outlive this and all that it reads.
    explicit ClipFiles(const gpu::Device& device) : device_(device) {}
    // Waits for the file that is being read.
    ~ClipFiles();
    ClipFiles(const ClipFiles&) = delete;
    ClipFiles& operator=(const ClipFiles&) = delete;

    // The segment, if it is on the device and in use, also as a part of another clip, and its file has not changed
    // since; else null. A clip that is one file is a segment, too.
    std::shared_ptr<const LoadedClip> find(const voctree::ClipSegment& segment);
    // The same, read now where it is not there. Throws InputError where read_segment does; RuntimeFailure where the
    // device has no memory.
    std::shared_ptr<const LoadedClip> read(const voctree::ClipSegment& segment);

    // Has these segments read on the thread, one after the other. They replace those of earlier calls that are not
    // being read yet.
    void read_ahead(std::vector<voctree::ClipSegment> wanted);

    // A segment that the thread has read, or the line that says why it could not.
    struct Result {
        std::filesystem::path file;
        std::shared_ptr<const LoadedClip> clip;
        std::string problem;
    };
    // The results since the last call. Until then, they keep what was read on the device.
    std::vector<Result> take_results();

  private:
    std::shared_ptr<const LoadedClip> find_locked(const std::filesystem::path& path, const FileStamp& stamp) const;
    std::shared_ptr<const LoadedClip> load(const voctree::ClipSegment& segment, const FileStamp& stamp);
    Result load_ahead(const voctree::ClipSegment& segment);
    void run();
    const gpu::Device& device_;
    std::mutex mutex_;  // guards all that follows
    std::condition_variable changed_;
    std::vector<std::weak_ptr<const LoadedClip>> known_;  // all that are in use
    std::deque<voctree::ClipSegment> wanted_;
    std::filesystem::path being_read_;  // by the thread; empty: none
    std::vector<Result> results_;
    bool stop_ = false;
    std::thread thread_;  // begins with the first read_ahead()
};

}  // namespace neuvv::render
