// Reads clips for a stage to come on a thread of its own, so that StageLoader::load then finds them on the device, and
// no image waits for them.
#pragma once

#include <atomic>
#include <exception>
#include <functional>

#include "render/clips/clip_files.h"

namespace neuvv::render {

class ClipPreload {
  public:
    // Begins to read what load() of a loader with these files would read: of a segmented clip or a stream, the first
    // segment that can be read. `each` is called on the thread when a clip is read, with the number of those that are,
    // but not for the last; `done`, when all is read, or a clip could not be. Either may be empty. What `files` reads
    // on must outlive this object.
    using Each = std::function<void(size_t read)>;
    ClipPreload(std::shared_ptr<ClipFiles> files, std::vector<std::filesystem::path> clips, Each each,
                std::function<void()> done);
    // Waits for the file that is being read, but not for servers that have answered before.
    ~ClipPreload();
    ClipPreload(const ClipPreload&) = delete;
    ClipPreload& operator=(const ClipPreload&) = delete;

    const std::vector<std::filesystem::path>& clips() const { return clips_; }
    bool is_done() const { return done_; }
    // Once it is done: throws the InputError of the clip that could not be read. Of other failures, such as a lack of
    // memory, it says nothing: load() meets them again, and may help itself.
    void expect_read() const;

  private:
    void run(const Each& each, const std::function<void()>& done);
    void read(const std::filesystem::path& clip);
    void read_segment(const voctree::ClipSegment& segment);
    std::shared_ptr<ClipFiles> files_;
    std::vector<std::filesystem::path> clips_;
    // What was read, which is kept on the device until the stage has it; and streams, which stay open.
    std::vector<std::shared_ptr<const LoadedClip>> kept_;
    std::vector<voctree::ClipIndex> open_;
    std::exception_ptr problem_;
    std::atomic<bool> done_ = false;
    std::mutex mutex_;  // guards what follows
    bool stop_ = false;
    std::shared_ptr<const voctree::ClipSource> waits_for_;
    std::thread thread_;  // the last member, because the thread uses all of the above
};

}  // namespace neuvv::render
