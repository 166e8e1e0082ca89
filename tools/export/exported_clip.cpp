#include "tools/export/exported_clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/error.h"
#include "stage/evaluated_stage.h"
#include "stage/time_map.h"
#include "tools/options.h"
#include "voctree/coarse.h"
#include "voctree/tree_slice.h"

namespace neuvv::tools {

namespace {

constexpr double kLikeRotation = 1e-5;  // by how much edges of the turned unit cube may differ from one scale

uint32_t recorded_frames_of(const stage::Stage& stage) {
    const double frames = std::round(stage.duration_s * stage.fps);
    if (!(frames <= voctree::kMaxClipFrames))
        throw InputError(stage.file.path.string(), "", "is too long", "give the stage a duration");
    return std::max(1u, static_cast<uint32_t>(frames));
}

}  // namespace

std::string origin_text(const voctree::WorldFrame& capture) {
    const glm::dvec3& o = capture.origin;
    if (o == glm::dvec3(0)) return "";
    return fmt::format("; the file's origin is ({:.15g}, {:.15g}, {:.15g}) of the capture, +Y up", o.x, o.y, o.z);
}

// A clip keeps its rate as a float, so that of the export is rounded to one, too: otherwise 59.94 frames a second would
// drift off those of a clip of 29.97.
ExportedClip::ExportedClip(PublishedScene scene, std::optional<double> fps, bool in_stage)
    : scene_(std::move(scene)), in_stage_(in_stage) {
    assert(!in_stage || scene_.stage);
    if (!in_stage) capture_ = voctree::read_world_frame(scene_.clip);
    const auto recorded_fps = in_stage ? static_cast<float>(scene_.stage->fps) : scene_.index.fps;
    fps_ = double{fps ? static_cast<float>(*fps) : recorded_fps};
    step_ = double{recorded_fps} / fps_;
    recorded_frames_ = in_stage ? recorded_frames_of(*scene_.stage) : scene_.index.frames();
}

ExportedClip::Frames ExportedClip::frames_in(const std::string& range) const {
    const FrameRange part = parse_frame_range(range, recorded_frames_);
    if (part.first != std::floor(part.first) || part.last != std::floor(part.last))
        throw InputError("--frames", range, "lies between two frames", "write whole frames");
    const auto first_from = [&](double recorded) { return std::ceil(recorded / step_ - stage::kFrameTolerance); };
    const double first = first_from(part.first), end = first_from(part.last + 1);
    if (!(end <= voctree::kMaxClipFrames))
        throw InputError("--fps", fmt::format("{}", fps_),
                         fmt::format("makes more than {} frames", voctree::kMaxClipFrames), "choose a lower one");
    if (!(first < end))
        throw InputError("--frames", range, fmt::format("has no frame at {} a second", fps_),
                         "choose more of them, or a higher --fps");
    return {static_cast<uint32_t>(first), static_cast<uint32_t>(end) - 1};
}

double ExportedClip::recorded_frame(uint32_t frame) const {
    const double at = frame * step_, whole = std::round(at);
    return std::min(std::abs(at - whole) <= stage::kFrameTolerance ? whole : at, recorded_frames_ - 1.0);
}

ExportedClip::Pose ExportedClip::pose_at(uint32_t frame) const {
    Pose pose{recorded_frame(frame)};
    if (!in_stage_) return pose;
    const stage::Stage& stage = *scene_.stage;
    const double time_s = frame / fps_;
    const stage::EvaluatedPerformer found = stage::stage_at(stage, time_s).performers[scene_.performer];
    pose.frame = double{found.frame};
    pose.hidden = !found.visible || found.opacity <= 0;
    if (pose.hidden) return pose;
    const glm::dmat3 axes(found.world_from_performer);
    pose.scale = std::cbrt(std::max(glm::determinant(axes), 0.0));
    const glm::dmat3 turn = axes / pose.scale;
    const glm::dmat3 rest = glm::transpose(turn) * turn - glm::dmat3(1);
    const double off = std::sqrt(glm::dot(rest[0], rest[0]) + glm::dot(rest[1], rest[1]) + glm::dot(rest[2], rest[2]));
    if (!(off <= kLikeRotation))
        throw InputError("--stage-space", fmt::format("\"{}\"", stage.performers[scene_.performer].name),
                         fmt::format("is stretched, sheared or mirrored at {:.6g} s", time_s),
                         "give the performer and the nodes above it one scale for all axes");
    pose.rotation = glm::normalize(glm::quat_cast(turn));
    pose.shift = glm::conjugate(pose.rotation) * glm::dvec3(found.world_from_performer[3]);
    return pose;
}

ExportedClip::Segment::Segment(const PublishedScene& scene, const voctree::ClipSegment& segment)
    : content(segment.source->content(segment, stream::kShFine, voctree::PlenoctreeColours::kLinear)) {
    if (const auto* tree = std::get_if<voctree::VOctree>(&content)) paint = read_segment_layers(scene, segment, *tree);
}

ExportedClip::Shown ExportedClip::shown(uint32_t frame) {
    const voctree::SegmentFrame at = voctree::segment_frame(scene_.index, pose_at(frame).frame);
    if (!segment_ || segment_index_ != at.segment) {
        segment_.reset();  // before the next one is read: together they may be too large
        segment_ = std::make_unique<Segment>(scene_, scene_.index.segments[at.segment]);
        segment_index_ = at.segment;
    }
    return {*segment_, double{at.frame}};
}

slice::Slice ExportedClip::slice_of(uint32_t frame) {
    const auto& [segment, at] = shown(frame);
    const Pose pose = pose_at(frame);
    slice::Slice slice = voctree::slice_at(segment.content, at, segment.paint.steps);
    if (pose.hidden) slice.leaves.clear();
    return slice::scaled(std::move(slice), pose.scale, pose.shift);
}

voctree::VOctree ExportedClip::still(uint32_t frame) {
    const slice::Slice slice = slice_of(frame);
    return voctree::tree_of(slice::values_of(slice::quantised(slice), slice.box_min, slice.box_size), scene_.index.fps);
}

uint32_t ExportedClip::finest_depth(uint32_t frame) {
    const voctree::SegmentContent& content = shown(frame).segment.content;
    if (const auto* tree = std::get_if<voctree::VOctree>(&content)) return voctree::finest_depth(*tree);
    uint32_t finest = 1;
    for (const stream::Leaf& leaf : std::get<voctree::FrameSlice>(content).slice->leaves)
        finest = std::max(finest, leaf.depth);
    return finest;
}

}  // namespace neuvv::tools
