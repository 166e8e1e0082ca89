#include "editor/paint/paint_carrier.h"

#include <algorithm>
#include <unordered_set>

#include "edit/carry.h"

namespace neuvv::editor {

namespace {

bool has_any(const edit::EditFrames& frames) {
    return frames.first <= frames.last;
}

// Those that hold at a frame.
PaintCarrier::Edits holding_at(const PaintCarrier::Edits& edits, float frame) {
    PaintCarrier::Edits holding;
    for (const voctree::LeafEdit& edit : edits)
        if (edit.first <= frame && frame <= edit.last) holding.push_back(edit);
    return holding;
}

}  // namespace

edit::EditFrames frames_in(const edit::EditFrames& frames, const voctree::ClipSegment& segment) {
    edit::EditFrames part = frames;
    const auto begin = static_cast<float>(segment.first);
    part.first = std::max(frames.first - begin, 0.0f);
    part.last = std::min(frames.last - begin, static_cast<float>(segment.frames_of_file() - 1));
    return part;
}

PaintCarrier::PaintCarrier(const voctree::ClipIndex& index, const edit::EditFrames& frames, uint32_t seen,
                           std::shared_ptr<const PaintClip> clip, Edits selected)
    : index_(index),
      frames_(frames),
      seen_(seen),
      seen_clip_(std::move(clip)),
      selected_(std::move(selected)),
      seen_edits_(edit::at_frames(seen_clip_->canvas, selected_, frames_in(frames, index.segments[seen]))),
      number_(seen),
      last_{seen_clip_, seen_edits_} {}

std::optional<uint32_t> PaintCarrier::next() {
    while (step()) {
        if (is_reached()) return number_;
        last_ = {};
    }
    return std::nullopt;
}

// From one segment to the next; from the last one, to the one before the segment that is seen. False: there is none.
bool PaintCarrier::step() {
    if (direction_ > 0 && number_ + 1 < index_.segments.size()) {
        ++number_;
        return true;
    }
    if (direction_ > 0) {
        direction_ = -1;
        number_ = seen_;
        last_ = {seen_clip_, seen_edits_};
    }
    if (number_ == 0) return false;
    --number_;
    return true;
}

// Whether the segment may get edits. Where edits hold as long as leaves stay opaque, those of the segment before that
// hold until its end go on in this one.
bool PaintCarrier::is_reached() {
    going_on_.clear();
    const bool in_frames = has_any(frames_in(frames_, index_.segments[number_]));
    if (frames_.follow == edit::Follow::kRun && !in_frames && last_.clip) {
        const float end = direction_ > 0 ? static_cast<float>(last_.clip->tree.frames - 1) : 0;
        going_on_ = edit::in_runs(last_.clip->canvas, holding_at(last_.edits, end), end);
    }
    return in_frames || !going_on_.empty() || frames_.follow == edit::Follow::kAll;
}

PaintCarrier::Edits PaintCarrier::edits_in(const std::shared_ptr<const PaintClip>& clip) {
    const voctree::ClipSegment& segment = index_.segments[number_];
    Edits edits = edit::carried(seen_clip_->canvas, selected_, clip->canvas);
    if (!going_on_.empty()) {
        std::unordered_set<uint32_t> there;
        for (const voctree::LeafEdit& edit : edit::carried(last_.clip->canvas, going_on_, clip->canvas))
            there.insert(edit.leaf);
        std::erase_if(edits, [&](const voctree::LeafEdit& edit) { return !there.contains(edit.leaf); });
        edits =
            edit::in_runs(clip->canvas, edits, direction_ > 0 ? 0 : static_cast<float>(segment.frames_of_file() - 1));
    } else {
        edits = edit::at_frames(clip->canvas, edits, frames_in(frames_, segment));
    }
    last_ = edits.empty() ? Painted{} : Painted{clip, edits};
    return edits;
}

}  // namespace neuvv::editor
