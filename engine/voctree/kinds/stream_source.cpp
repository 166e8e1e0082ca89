#include "voctree/kinds/stream_source.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "base/error.h"
#include "base/platform.h"
#include "voctree/files/occupied_box.h"
#include "voctree/tree_slice.h"

namespace neuvv::voctree {

namespace {

// By how much of their box's size leaves may move between frames that stand alone.
constexpr double kMoves = 0.1;

glm::vec3 vector_of(const std::array<float, 3>& numbers) {
    return {numbers[0], numbers[1], numbers[2]};
}

// Of a part of the group's box, metres.
glm::dvec3 point_of(const stream::Group& group, const std::array<float, 3>& part) {
    return glm::dvec3(vector_of(group.box_min)) + glm::dvec3(vector_of(part)) * glm::dvec3(vector_of(group.box_size));
}

class StreamSource : public ClipSource {
  public:
    explicit StreamSource(std::shared_ptr<stream::Reader> reader) : reader_(std::move(reader)) {
        for (const stream::Group& group : reader_->index().groups) {
            const FrameBound one{group.format.most_leaves, group.format.degree};
            if (one.leaves * sh_count(one.degree) >= bound_.leaves * sh_count(bound_.degree)) bound_ = one;
        }
    }

    FileStamp stamp(const ClipSegment&) const override { return reader_->stamp(); }
    NvvHeader header(const ClipSegment& segment) const override {
        const stream::Group& group = group_of(segment);
        return {group.format.depth / 2,
                0,
                0,
                group.format.most_leaves,
                1,
                group.format.degree,
                1,
                reader_->index().fps,
                vector_of(group.box_min),
                vector_of(group.box_size)};
    }
    SegmentContent content(const ClipSegment& segment, stream::Part last, PlenoctreeColours) const override {
        keep_freed_memory();  // a frame has tens of megabytes of arrays, which take as long to clear as to fill
        return read(segment, last);
    }
    Box box(const ClipSegment& segment) const override {
        const FrameSlice frame = read(segment, stream::kShape);
        const auto leaves = occupied_box(leaf_positions(*frame.slice), frame.box_min, frame.box_size);
        const glm::dvec3 low(frame.box_min), high = low + glm::dvec3(frame.box_size),
                                             moved = kMoves * (leaves.second - leaves.first);
        return {glm::max(low, leaves.first - moved), glm::min(high, leaves.second + moved),
                !frame.slice->leaves.empty()};
    }
    std::optional<Box> box_of_all() const override {
        std::optional<Box> all;
        for (const stream::Group& group : reader_->index().groups) {
            if (!group.filled) return {};
            const glm::dvec3 low = point_of(group, group.filled->low), high = point_of(group, group.filled->high);
            const bool has_leaves = group.filled->low != group.filled->high;
            if (!all || (has_leaves && !all->has_leaves))
                all = Box{low, high, has_leaves};
            else if (has_leaves)
                all = Box{glm::min(all->low, low), glm::max(all->high, high), true};
        }
        if (all && !all->has_leaves) return {};
        return all;
    }
    bool stands_alone(const ClipSegment& segment) const override {
        return reader_->index().frames[segment.first].is_key;
    }
    void expect_paintable() const override {
        throw InputError(reader_->path().string(), "", "is a stream, which cannot be painted",
                         "paint the clip that it was published from");
    }

    std::optional<FrameBound> plays_by_frame() const override { return bound_; }
    stream::GroupCost group_cost(const ClipSegment& segment) const override { return reader_->cost_of(segment.first); }
    std::optional<double> bytes_per_s() const override { return reader_->bytes_per_s(); }
    bool has_server() const override { return stream::is_address(reader_->path()); }
    void cancel() const override { reader_->cancel(); }

  private:
    const stream::Group& group_of(const ClipSegment& segment) const {
        const stream::Index& index = reader_->index();
        return index.groups[index.group_of(segment.first)];
    }
    FrameSlice read(const ClipSegment& segment, stream::Part last) const {
        const stream::Group& group = group_of(segment);
        FrameSlice frame{nullptr, vector_of(group.box_min), vector_of(group.box_size)};
        frame.slice = reader_->frame(segment.first, last, &frame.times);
        return frame;
    }
    std::shared_ptr<stream::Reader> reader_;
    FrameBound bound_;
};

}  // namespace

std::shared_ptr<stream::Reader> open_stream(const std::filesystem::path& path) {
    static std::mutex mutex;
    static std::map<std::filesystem::path, std::weak_ptr<stream::Reader>> open;
    const auto is_current = [&](const stream::Reader& reader) {
        return !reader.has_failed() && (stream::is_address(path) || reader.stamp() == neuvv::stamp_of(path));
    };
    {
        const std::lock_guard lock(mutex);
        std::erase_if(open, [](const auto& one) { return one.second.expired(); });
        if (const auto found = open.find(path); found != open.end())
            if (auto reader = found->second.lock(); reader && is_current(*reader)) return reader;
    }
    auto reader = std::make_shared<stream::Reader>(path);  // which may take as long as a server does
    reader->read_first_ahead();
    const std::lock_guard lock(mutex);
    open[path] = reader;
    return reader;
}

ClipIndex index_of_stream(const std::filesystem::path& path) {
    const std::shared_ptr<stream::Reader> reader = open_stream(path);
    const auto source = std::make_shared<const StreamSource>(reader);
    ClipIndex index{reader->index().fps, {}};
    const auto frames = static_cast<uint32_t>(reader->index().frames.size());
    index.segments.reserve(frames);
    for (uint32_t frame = 0; frame < frames; ++frame)
        index.segments.push_back({path / segment_file_name(frame), frame, 1, 0, source});
    return index;
}

}  // namespace neuvv::voctree
