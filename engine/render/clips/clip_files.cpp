#include "render/clips/clip_files.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/error.h"
#include "base/seconds.h"
#include "base/trace_file.h"
#include "stream/transport/byte_source.h"

namespace neuvv::render {

ClipFiles::~ClipFiles() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        for (const auto& [file, source] : being_read_) source->cancel();
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

std::shared_ptr<const LoadedClip> ClipFiles::find_in(const Known& known, const std::filesystem::path& path,
                                                     const FileStamp& stamp) {
    for (const auto& one : known)
        if (const auto clip = one.lock(); clip && clip->path == path && clip->stamp == stamp) return clip;
    return nullptr;
}

std::shared_ptr<const LoadedClip> ClipFiles::find(const voctree::ClipSegment& segment) {
    const FileStamp stamp = segment.source->stamp(segment);
    const std::lock_guard lock(mutex_);
    return find_in(known_, segment.file, stamp);
}

std::shared_ptr<const LoadedClip> ClipFiles::find_parts(const voctree::ClipSegment& segment) {
    const FileStamp stamp = segment.source->stamp(segment);
    const std::lock_guard lock(mutex_);
    return find_in(known_parts_, segment.file, stamp);
}

// A file is read by one thread at a time; others wait, and then find it. Returns it where it is known; else the caller
// reads it now, and then calls end_reading().
std::shared_ptr<const LoadedClip> ClipFiles::begin_reading(const voctree::ClipSegment& segment,
                                                           const FileStamp& stamp) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !being_read_.contains(segment.file); });
    if (auto known = find_in(known_, segment.file, stamp)) return known;
    being_read_.emplace(segment.file, segment.source);
    return nullptr;
}

// `whole` is what was read; null where it could not be, or is only a part.
void ClipFiles::end_reading(const voctree::ClipSegment& segment, const std::shared_ptr<const LoadedClip>& whole) {
    {
        const std::lock_guard lock(mutex_);
        being_read_.erase(segment.file);
        std::erase_if(known_, [](const auto& one) { return one.expired(); });
        if (whole) known_.push_back(whole);
    }
    changed_.notify_all();
}

std::shared_ptr<FramePace> ClipFiles::pace_of(const voctree::ClipSegment& segment) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<FramePace>& pace = paces_[segment.file.parent_path()];
    if (!pace) pace = std::make_shared<FramePace>(stream::frames_at_once());
    return pace;
}

// Reads and uploads a segment, of a frame of a stream the parts up to `last`. `asked_s`: seconds_now() at which it was
// wanted in time; nothing where somebody waits for it.
std::shared_ptr<const LoadedClip> ClipFiles::load(const voctree::ClipSegment& segment, const FileStamp& stamp,
                                                  stream::Part last, std::optional<double> asked_s) {
    auto clip = std::make_shared<const LoadedClip>(
        LoadedClip{upload_segment(device_, segment, FarLevels::kYes, solid_, last), segment.file, stamp});
    if (!clip->times) return clip;
    const std::shared_ptr<FramePace> pace = pace_of(segment);
    pace->learn(clip->times->decoded, clip->times->upload_s);
    if (asked_s) pace->learn_arrival(seconds_now() - *asked_s);
    return clip;
}

std::shared_ptr<const LoadedClip> ClipFiles::read_once(const voctree::ClipSegment& segment,
                                                       std::optional<double> asked_s) {
    const FileStamp stamp = segment.source->stamp(segment);
    if (auto known = begin_reading(segment, stamp)) return known;
    try {
        const TraceSpan span("read a segment of frame", segment.first);
        auto clip = load(segment, stamp, stream::kShFine, asked_s);
        end_reading(segment, clip);
        return clip;
    } catch (...) {
        end_reading(segment, nullptr);
        throw;
    }
}

// What is being read holds memory for the copy to the device, too, which then is free again. Frames that come from a
// server may take longer, and hold none while they do. Returns whether there was something to wait for.
bool ClipFiles::wait_for_others() {
    std::unique_lock lock(mutex_);
    std::vector<std::filesystem::path> others;
    for (const auto& [file, source] : being_read_)
        if (!source->has_server()) others.push_back(file);
    changed_.wait_for(lock, std::chrono::seconds(1), [&] {
        return std::ranges::none_of(others, [&](const auto& file) { return being_read_.contains(file); });
    });
    return !others.empty();
}

std::shared_ptr<const LoadedClip> ClipFiles::read(const voctree::ClipSegment& segment) {
    try {
        return read_once(segment);
    } catch (const gpu::VulkanError& error) {
        if (!error.out_of_memory() || !wait_for_others()) throw;
    }
    return read_once(segment);
}

ClipFiles::Paints ClipFiles::read_paints(const voctree::ClipSegment& segment, const LoadedClip& clip,
                                         const std::vector<LayerFolders>& layers) {
    Paints paints;
    for (const LayerFolders& one : layers) paints.push_back(read_paint(segment, clip, one));
    return paints;
}

std::shared_ptr<const SegmentPaint> ClipFiles::read_paint(const voctree::ClipSegment& segment, const LoadedClip& clip,
                                                          const LayerFolders& of_clip) {
    const LayerFolders layers = of_segment(of_clip, segment);
    const std::vector<FileStamp> stamps = stamps_of(layers, segment);
    {
        const std::lock_guard lock(mutex_);
        for (const KnownPaint& known : known_paints_)
            if (const auto paint = known.paint.lock(); paint && known.segment == clip.path &&
                                                       known.stamp == clip.stamp && paint->layers == layers &&
                                                       paint->stamps == stamps)
                return paint;
    }
    SegmentPaint read{layers, stamps, nullptr, {}};
    try {
        read.paint = load_segment_paint(device_, layers, segment, clip.painted);
    } catch (const InputError& problem) {
        read.problem = Note(problem);
    }
    auto paint = std::make_shared<const SegmentPaint>(std::move(read));
    const std::lock_guard lock(mutex_);
    std::erase_if(known_paints_, [](const KnownPaint& one) { return one.paint.expired(); });
    known_paints_.push_back({clip.path, clip.stamp, paint});
    return paint;
}

void ClipFiles::read_ahead(std::vector<Wanted> wanted) {
    {
        const std::lock_guard lock(mutex_);
        if (wanted_.empty() && wanted.empty()) return;
        wanted_.assign(wanted.begin(), wanted.end());
        wanted_s_ = seconds_now();
        if (threads_.empty())
            for (uint32_t i = 0; i <= stream::frames_at_once(); ++i) threads_.emplace_back([this, i] { run(i > 0); });
    }
    changed_.notify_all();
}

std::vector<ClipFiles::Result> ClipFiles::take_results() {
    const std::lock_guard lock(mutex_);
    return std::exchange(results_, {});
}

// Whether there is one that nobody has taken yet.
bool ClipFiles::has_result(const voctree::ClipSegment& segment) {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(results_, [&](const Result& one) { return one.file == segment.file && one.clip; });
}

void ClipFiles::add_result(Result result) {
    const std::lock_guard lock(mutex_);
    results_.push_back(std::move(result));
}

void ClipFiles::read_coarse(const voctree::ClipSegment& segment) {
    const FileStamp stamp = segment.source->stamp(segment);
    std::optional<UploadedSegment> coarse = upload_coarse(device_, segment, solid_);
    if (!coarse) return;
    auto clip = std::make_shared<const LoadedClip>(LoadedClip{std::move(*coarse), segment.file, stamp});
    add_result({segment.file, stamp, std::move(clip), "", true, {}});
}

// Returns false, and does nothing, where all of the frame comes in time, or is there.
bool ClipFiles::read_in_time(const voctree::ClipSegment& segment, double asked_s) {
    const stream::Part last = pace_of(segment)->part_in_time(segment.source->group_cost(segment),
                                                             segment.source->bytes_per_s(), seconds_now());
    if (last == stream::kShFine) return false;
    const FileStamp stamp = segment.source->stamp(segment);
    if (begin_reading(segment, stamp)) return false;
    if (has_result(segment)) {  // it was still wanted when another thread had just read it
        end_reading(segment, nullptr);
        return true;
    }
    try {
        const TraceSpan span("read a part of frame", segment.first);
        const std::shared_ptr<const LoadedClip> parts = load(segment, stamp, last, asked_s);
        {
            const std::lock_guard lock(mutex_);
            std::erase_if(known_parts_, [](const auto& one) { return one.expired(); });
            known_parts_.push_back(parts);
        }
        add_result({segment.file, stamp, parts, "", true, {}});
    } catch (...) {
        end_reading(segment, nullptr);
        throw;
    }
    end_reading(segment, nullptr);
    return true;
}

void ClipFiles::read_one_ahead(const Wanted& wanted, double asked_s) {
    const FileStamp stamp = wanted.segment.source->stamp(wanted.segment);
    try {
        if (wanted.in_time && read_in_time(wanted.segment, asked_s)) return;
        if (wanted.is_urgent && !find(wanted.segment)) read_coarse(wanted.segment);
        const std::shared_ptr<const LoadedClip> clip =
            read_once(wanted.segment, wanted.in_time ? std::optional(asked_s) : std::nullopt);
        add_result({wanted.segment.file, stamp, clip, {}, false, read_paints(wanted.segment, *clip, wanted.layers)});
    } catch (const stream::ServerProblem& problem) {
        add_result({wanted.segment.file, stamp, nullptr, Note(problem), false, {}, true});
        pause();
    } catch (const InputError& problem) {
        add_result({wanted.segment.file, stamp, nullptr, Note(problem), false, {}});
    } catch (const std::exception& problem) {  // no memory: there may be some later
        const auto* vulkan = dynamic_cast<const gpu::VulkanError*>(&problem);
        const bool lacks_memory = vulkan && vulkan->out_of_memory();
        add_result({wanted.segment.file, stamp, nullptr, Note(problem), false, {}, true, lacks_memory});
        pause();
    }
}

// Before what failed is tried again.
void ClipFiles::pause() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(1), [this] { return stop_; });
}

std::deque<ClipFiles::Wanted>::iterator ClipFiles::next_locked(bool frames) {
    const auto is_taken = [&](const voctree::ClipSource& source) {
        return frames ? source.plays_by_frame().has_value() : !source.has_server();
    };
    return std::find_if(wanted_.begin(), wanted_.end(), [&](const Wanted& one) {
        return !being_read_.contains(one.segment.file) && is_taken(*one.segment.source);
    });
}

void ClipFiles::run(bool frames) {
    name_trace_thread(frames ? "reads frames" : "reads files");
    for (;;) {
        Wanted next;
        double asked_s = 0;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return stop_ || next_locked(frames) != wanted_.end(); });
            if (stop_) return;
            const auto chosen = next_locked(frames);
            next = std::move(*chosen);
            wanted_.erase(chosen);
            asked_s = wanted_s_;
        }
        read_one_ahead(next, asked_s);
    }
}

}  // namespace neuvv::render
