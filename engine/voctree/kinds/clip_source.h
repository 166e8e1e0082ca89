// What segments of clips are read from: a class for each kind of file. Who plays or exports a segment asks its source,
// and not which kind it is.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "base/file_stamp.h"
#include "slice/slice.h"
#include "stream/transport/nvs_reader.h"
#include "voctree/files/clip_index.h"
#include "voctree/files/nvv.h"
#include "voctree/slice_paint.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

// A slice in whole numbers in a box, metres.
struct FrameSlice {
    std::shared_ptr<const stream::QuantisedSlice> slice;
    glm::vec3 box_min, box_size;
    stream::DecodeTimes times{};  // what it took
};

// What a segment holds: a tree with bases, of which the device makes slices, or the slice of its one frame.
using SegmentContent = std::variant<VOctree, FrameSlice>;
// What it shows at one of its frames, or between two, under layers of paint, of which a slice has none (assert): the
// leaves of opacity slice::kLeastOpacity or more.
slice::Slice slice_at(const SegmentContent& content, double frame, std::span<const PaintStep> paint = {});

// All functions may be called from any thread. They throw InputError with file, place and fix where the segment's file
// is damaged, and stream::ServerProblem where a server does not answer.
class ClipSource {
  public:
    virtual ~ClipSource() = default;

    // Of the segment's file; of a whole stream, when it was opened.
    virtual FileStamp stamp(const ClipSegment& segment) const = 0;
    // Leaves are not read: `leaf_count` is 0 only where there are none, and else may be a bound.
    virtual NvvHeader header(const ClipSegment& segment) const = 0;
    // `last`: of a stream, the last part that is decoded. `colours`: of a PlenOctree.
    virtual SegmentContent content(const ClipSegment& segment, stream::Part last, PlenoctreeColours colours) const = 0;
    // A tree of few leaves that is read sooner, where the file has one. Nothing where the file cannot be read:
    // content() throws then.
    virtual std::optional<VOctree> coarse(const ClipSegment&) const { return {}; }

    // Around the leaves of the segment and what is near in time, metres, and whether there are any. As little is read
    // as has to be.
    struct Box {
        glm::dvec3 low, high;
        bool has_leaves;
    };
    virtual Box box(const ClipSegment& segment) const = 0;
    // Around the leaves of all segments that it has, where the file says so without them; else nothing.
    virtual std::optional<Box> box_of_all() const { return {}; }
    // Whether it can be read without those before it.
    virtual bool stands_alone(const ClipSegment&) const { return true; }
    // Throws InputError where there are no bases, which paint needs.
    virtual void expect_paintable() const {}

    // What a frame takes at most, where each frame is a segment that comes as its slice while the clip plays; else
    // nothing.
    virtual std::optional<FrameBound> plays_by_frame() const { return {}; }
    // Of such clips, what the segment's group of frames costs, and the bytes a second that a server sends; nothing
    // where all is here.
    virtual stream::GroupCost group_cost(const ClipSegment&) const { return {}; }
    virtual std::optional<double> bytes_per_s() const { return {}; }
    // Whether reading may wait for a server. cancel() ends that, in all threads and from now on (ServerProblem).
    virtual bool has_server() const { return false; }
    virtual void cancel() const {}
};

}  // namespace neuvv::voctree
