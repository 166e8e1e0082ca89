#include "render/stage_clips.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace neuvv::render {

namespace {

// How far segments are read ahead of the stage's clock, and at which times in between it is asked which they are.
constexpr double kAhead_s = 2, kAheadStep_s = 0.25;
// A larger step of the clock is a jump, which says nothing about its direction.
constexpr double kJump_s = 0.5;

bool contains(const auto& list, const auto& one) {
    return std::find(list.begin(), list.end(), one) != list.end();
}

}  // namespace

StageClips::StageClips(const StageAssets& assets)
    : clips_(assets.clips), files_(assets.files), problems_(assets.problems), shown_(assets.paint.size()) {
    segmented_ =
        std::any_of(clips_.begin(), clips_.end(), [](const ClipOnDevice& clip) { return clip.segments.size() > 1; });
}

std::vector<const Field*> StageClips::fields() const {
    std::vector<const Field*> fields;
    for (const ClipOnDevice& clip : clips_)
        for (const ClipOnDevice::Segment& segment : clip.segments)
            if (segment.loaded && !contains(fields, &segment.loaded->field)) fields.push_back(&segment.loaded->field);
    return fields;
}

uint32_t StageClips::max_fields() const {
    uint32_t fields = 0;
    for (const ClipOnDevice& clip : clips_)
        fields += std::min(static_cast<uint32_t>(clip.segments.size()), kSegmentsOnDevice);
    return fields;
}

StageClips::Shown StageClips::wanted_by(const stage::EvaluatedPerformer& performer) const {
    const auto [segment, frame] = voctree::segment_frame(clips_[performer.clip].index, double{performer.frame});
    return {{performer.clip, segment}, frame};
}

std::optional<StageClips::Place> StageClips::place_of(const stage::EvaluatedPerformer& performer) const {
    Shown shown = wanted_by(performer);
    if (!at(shown.id).loaded && at(shown.id).readable && shown_[performer.performer])
        shown = *shown_[performer.performer];
    if (shown.id.clip != performer.clip || !at(shown.id).loaded) return std::nullopt;
    return Place{&at(shown.id).loaded->field, shown.frame};
}

void StageClips::fail(Id id, const std::string& problem) {
    at(id).readable = false;
    if (!contains(problems_, problem)) problems_.push_back(problem);
}

// Takes what the thread has read. Returns whether there was anything.
bool StageClips::take_results() {
    bool any = false;
    for (const ClipFiles::Result& result : files_->take_results())
        for (uint32_t clip = 0; clip < clips_.size(); clip++)
            for (uint32_t i = 0; i < clips_[clip].segments.size(); i++) {
                if (clips_[clip].index.segments[i].file != result.file) continue;
                if (result.clip)
                    at({clip, i}).loaded = result.clip;
                else
                    fail({clip, i}, result.problem);
                any = true;
            }
    return any;
}

// Returns whether the segment was not on the device and now is.
bool StageClips::read_now(Id id) {
    if (at(id).loaded || !at(id).readable) return false;
    try {
        at(id).loaded = files_->read(clips_[id.clip].index.segments[id.segment]);
    } catch (const InputError& problem) {
        fail(id, problem.what());
    }
    return at(id).loaded != nullptr;
}

// What the performers show at this time, and what they show in place of what is not on the device.
std::vector<StageClips::Id> StageClips::needed_at(const stage::EvaluatedStage& evaluated) const {
    std::vector<Id> needed, held;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (!performer.visible) continue;
        const Id id = wanted_by(performer).id;
        if (!contains(needed, id)) needed.push_back(id);
        if (at(id).loaded || !shown_[performer.performer]) continue;
        if (const Id last = shown_[performer.performer]->id; last.clip == id.clip) held.push_back(last);
    }
    for (const Id& id : held)
        if (!contains(needed, id)) needed.push_back(id);
    return needed;
}

// What the performers show next, the earliest first.
std::vector<StageClips::Id> StageClips::ahead_of(const stage::Stage& stage,
                                                 const stage::EvaluatedStage& evaluated) const {
    std::vector<Id> ahead;
    for (double after_s = kAheadStep_s; after_s <= kAhead_s; after_s += kAheadStep_s)
        for (stage::EvaluatedPerformer performer : evaluated.performers) {
            if (!performer.visible || clips_[performer.clip].segments.size() == 1) continue;
            performer.frame = static_cast<float>(stage::frame_at(stage.performers[performer.performer].timeline,
                                                                 evaluated.time_s + direction_ * after_s));
            if (const Id id = wanted_by(performer).id; !contains(ahead, id)) ahead.push_back(id);
        }
    return ahead;
}

// Of each segmented clip: its first readable segment, those that are needed, and as many of those ahead and then of
// those that were shown as there is room for.
std::set<StageClips::Id> StageClips::chosen(const std::vector<Id>& needed, const std::vector<Id>& ahead) const {
    std::set<Id> chosen(needed.begin(), needed.end());
    std::vector<uint32_t> count(clips_.size());
    for (uint32_t clip = 0; clip < clips_.size(); clip++)
        for (uint32_t i = 0; i < clips_[clip].segments.size(); i++)
            if (at({clip, i}).loaded == clips_[clip].first) chosen.insert({clip, i});
    for (const Id& id : chosen) count[id.clip]++;
    for (const std::vector<Id>* list : {&ahead, &recent_})
        for (const Id& id : *list)
            if (count[id.clip] < kSegmentsOnDevice && at(id).readable && chosen.insert(id).second) count[id.clip]++;
    return chosen;
}

// Notes what performers show now, for when a segment is missing.
void StageClips::remember(const stage::EvaluatedStage& evaluated) {
    holds_ = false;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        const Shown shown = wanted_by(performer);
        if (performer.visible && !at(shown.id).loaded && at(shown.id).readable) holds_ = true;
        if (!performer.visible || !at(shown.id).loaded) continue;
        shown_[performer.performer] = shown;
        std::erase(recent_, shown.id);
        recent_.insert(recent_.begin(), shown.id);
    }
}

StageClips::Changes StageClips::follow(const stage::Stage& stage, const stage::EvaluatedStage& evaluated,
                                       MissingSegments missing) {
    Changes changes;
    if (!segmented_) return changes;
    if (const double step_s = evaluated.time_s - last_s_; step_s != 0 && std::abs(step_s) < kJump_s)
        direction_ = step_s < 0 ? -1 : 1;
    last_s_ = evaluated.time_s;
    changes.any = take_results();
    const std::vector<Id> needed = needed_at(evaluated), ahead = ahead_of(stage, evaluated);
    if (missing == MissingSegments::kWait)
        for (const Id& id : needed) changes.any |= read_now(id);
    const std::set<Id> kept = chosen(needed, ahead);
    for (uint32_t clip = 0; clip < clips_.size(); clip++)
        for (uint32_t i = 0; i < clips_[clip].segments.size(); i++)
            if (at({clip, i}).loaded && !kept.contains({clip, i}))
                changes.dropped.push_back(std::exchange(at({clip, i}).loaded, nullptr));
    changes.any |= !changes.dropped.empty();
    std::erase_if(recent_, [&](const Id& id) { return !kept.contains(id); });
    remember(evaluated);
    std::vector<Id> request;
    for (const std::vector<Id>* list : {&needed, &ahead})
        for (const Id& id : *list)
            if (kept.contains(id) && !at(id).loaded && at(id).readable && !contains(request, id)) request.push_back(id);
    if (request == requested_) return changes;
    std::vector<voctree::ClipSegment> segments;
    for (const Id& id : request) segments.push_back(clips_[id.clip].index.segments[id.segment]);
    files_->read_ahead(std::move(segments));
    requested_ = std::move(request);
    return changes;
}

}  // namespace neuvv::render
