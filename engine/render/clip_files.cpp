#include "render/clip_files.h"

#include <algorithm>
#include <utility>

#include "voctree/clip.h"

namespace neuvv::render {

ClipFiles::~ClipFiles() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

std::shared_ptr<const LoadedClip> ClipFiles::find_locked(const std::filesystem::path& path,
                                                         const FileStamp& stamp) const {
    for (const auto& one : known_)
        if (const auto clip = one.lock(); clip && clip->path == path && clip->stamp == stamp) return clip;
    return nullptr;
}

std::shared_ptr<const LoadedClip> ClipFiles::find(const voctree::ClipSegment& segment) {
    const FileStamp stamp = stamp_of(segment.file);
    const std::lock_guard lock(mutex_);
    return find_locked(segment.file, stamp);
}

std::shared_ptr<const LoadedClip> ClipFiles::load(const voctree::ClipSegment& segment, const FileStamp& stamp) {
    const voctree::VOctree tree = voctree::read_segment(segment);
    auto clip = std::make_shared<const LoadedClip>(
        LoadedClip{segment.file, stamp, upload_far_levels(device_, tree), voctree::painted_field(tree)});
    const std::lock_guard lock(mutex_);
    std::erase_if(known_, [](const auto& one) { return one.expired(); });
    known_.push_back(clip);
    return clip;
}

std::shared_ptr<const LoadedClip> ClipFiles::read(const voctree::ClipSegment& segment) {
    const FileStamp stamp = stamp_of(segment.file);
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return being_read_ != segment.file; });
        if (auto known = find_locked(segment.file, stamp)) return known;
    }
    return load(segment, stamp);
}

void ClipFiles::read_ahead(std::vector<voctree::ClipSegment> wanted) {
    {
        const std::lock_guard lock(mutex_);
        wanted_.assign(wanted.begin(), wanted.end());
        if (!thread_.joinable() && !wanted_.empty()) thread_ = std::thread([this] { run(); });
    }
    changed_.notify_all();
}

std::vector<ClipFiles::Result> ClipFiles::take_results() {
    const std::lock_guard lock(mutex_);
    return std::exchange(results_, {});
}

ClipFiles::Result ClipFiles::load_ahead(const voctree::ClipSegment& segment) {
    try {
        auto known = find(segment);
        return {segment.file, known ? known : load(segment, stamp_of(segment.file)), ""};
    } catch (const std::exception& error) {
        return {segment.file, nullptr, error.what()};
    }
}

void ClipFiles::run() {
    for (;;) {
        voctree::ClipSegment next;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return stop_ || !wanted_.empty(); });
            if (stop_) return;
            next = wanted_.front();
            wanted_.pop_front();
            being_read_ = next.file;
        }
        Result result = load_ahead(next);
        {
            const std::lock_guard lock(mutex_);
            results_.push_back(std::move(result));
            being_read_.clear();
        }
        changed_.notify_all();
    }
}

}  // namespace neuvv::render
