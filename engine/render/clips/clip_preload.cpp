#include "render/clips/clip_preload.h"

#include <utility>

#include "base/error.h"
#include "base/trace_file.h"

namespace neuvv::render {

ClipPreload::ClipPreload(std::shared_ptr<ClipFiles> files, std::vector<std::filesystem::path> clips, Each each,
                         std::function<void()> done)
    : files_(std::move(files)),
      clips_(std::move(clips)),
      thread_([this, one = std::move(each), all = std::move(done)] { run(one, all); }) {}

ClipPreload::~ClipPreload() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        if (waits_for_) waits_for_->cancel();
    }
    thread_.join();
}

void ClipPreload::expect_read() const {
    if (problem_) std::rethrow_exception(problem_);
}

void ClipPreload::run(const Each& each, const std::function<void()>& done) {
    name_trace_thread("reads new clips");
    try {
        for (size_t i = 0; i < clips_.size(); ++i) {
            read(clips_[i]);
            if (each && i + 1 < clips_.size()) each(i + 1);
        }
    } catch (const InputError&) {
        problem_ = std::current_exception();
    } catch (const std::exception&) {  // load() meets it again
    }
    done_ = true;
    if (done) done();
}

void ClipPreload::read(const std::filesystem::path& clip) {
    const voctree::ClipIndex& index = open_.emplace_back(voctree::read_clip_index(clip));
    for (const voctree::ClipSegment& segment : index.segments) try {
            return read_segment(segment);
        } catch (const InputError&) {
            const bool is_last = &segment == &index.segments.back();
            if (is_last || segment.source->plays_by_frame()) throw;
        }
}

void ClipPreload::read_segment(const voctree::ClipSegment& segment) {
    {
        const std::lock_guard lock(mutex_);
        if (stop_) throw RuntimeFailure("not wanted any more");
        waits_for_ = segment.source;
    }
    kept_.push_back(files_->read(segment));
    const std::lock_guard lock(mutex_);
    waits_for_.reset();
}

}  // namespace neuvv::render
