#include "render/clips/stage_clips.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "render/volume/slices/slice_upload.h"
#include "stream/transport/byte_source.h"

namespace neuvv::render {

namespace {

// How far segments are read ahead of the stage's clock, and at which times in between it is asked which they are.
constexpr double kAhead_s = 2, kAheadStep_s = 0.25, kLeastStep_s = 0.005;
// A larger step of the clock is a jump, which says nothing about its direction.
constexpr double kJump_s = 0.5;
// What a performer shows for longer is read as a whole: it may stand still for some time yet.
constexpr double kStands_s = 0.25;

// What is drawn of a segment; null: nothing is there.
const LoadedClip* drawn(const ClipOnDevice::Segment& segment) {
    return segment.loaded ? segment.loaded.get() : segment.coarse.get();
}

// How many segments of a clip are on the device at once.
uint32_t room_of(const ClipOnDevice& clip) {
    const std::optional<voctree::FrameBound> bound = clip.index.plays_by_frame();
    if (!bound) return kSegmentsOnDevice;
    const uint64_t bytes = std::max<uint64_t>(bound->leaves * slice_bytes_per_leaf(bound->degree), 1);
    return static_cast<uint32_t>(
        std::clamp<uint64_t>(kStreamBytesOnDevice / bytes, kLeastStreamFrames, kMostStreamFrames));
}

bool contains(const auto& list, const auto& one) {
    return std::find(list.begin(), list.end(), one) != list.end();
}

}  // namespace

StageClips::StageClips(const StageAssets& assets)
    : clips_(assets.clips),
      layers_(assets.layers),
      files_(assets.files),
      problems_(assets.problems),
      shown_(assets.paint.size()) {
    for (uint32_t clip = 0; clip < clips_.size(); ++clip) {
        const auto segments = static_cast<uint32_t>(clips_[clip].segments.size());
        for (uint32_t i = 0; i < segments && segments > 1; ++i) {
            const Id id{clip, i};
            ids_[file_of(id).file].push_back(id);
            if (drawn(at(id))) on_device_.insert(id);
            if (at(id).loaded == clips_[clip].first && !clips_[clip].index.plays_by_frame()) first_.insert(id);
        }
    }
    if (!ids_.empty()) return;
    files_->read_ahead({});  // for an earlier version of the stage
    files_->take_results();
}

void StageClips::go_on_from(const StageClips& before) {
    last_s_ = before.last_s_;
    direction_ = before.direction_;
    moved_s_ = before.moved_s_;
    goes_on_ = before.goes_on_;
    speed_ = before.speed_;
    // The same file at the same place in the same clip, though that may have another number now.
    const auto now = [&](const Id& id) -> std::optional<Id> {
        const auto found = ids_.find(before.file_of(id).file);
        if (found == ids_.end()) return std::nullopt;
        for (const Id& one : found->second)
            if (one.segment == id.segment) return one;
        return std::nullopt;
    };
    for (size_t i = 0; i < std::min(shown_.size(), before.shown_.size()); ++i)
        if (const auto& shown = before.shown_[i])
            if (const std::optional<Id> id = now(shown->id)) shown_[i] = Shown{*id, shown->frame};
    for (const Id& id : before.recent_)
        if (const std::optional<Id> one = now(id); one && on_device_.contains(*one)) recent_.push_back(*one);
}

std::vector<const Field*> StageClips::fields() const {
    std::vector<const Field*> fields;
    const auto add = [&](const LoadedClip* one) {
        if (one && !contains(fields, &one->field)) fields.push_back(&one->field);
    };
    for (const ClipOnDevice& clip : clips_)
        if (clip.segments.size() == 1) add(drawn(clip.segments[0]));
    for (const Id& id : on_device_) add(drawn(at(id)));
    return fields;
}

uint32_t StageClips::usual_fields() const {
    uint32_t fields = 0;
    for (const ClipOnDevice& clip : clips_)
        if (!clip.index.plays_by_frame())
            fields += std::min(static_cast<uint32_t>(clip.segments.size()), room_of(clip));
    return fields;
}

StageClips::Shown StageClips::wanted_by(const stage::EvaluatedPerformer& performer) const {
    const auto [segment, frame] = voctree::segment_frame(clips_[performer.clip].index, double{performer.frame});
    return {{performer.clip, segment}, frame};
}

// Those that a performer shows at its time: one, or two where one fades into the next, the one of wanted_by first.
std::vector<StageClips::Id> StageClips::segments_of(const stage::EvaluatedPerformer& performer) const {
    std::vector<Id> ids;
    for (const voctree::SegmentShare& one :
         voctree::segment_shares(clips_[performer.clip].index, double{performer.frame}))
        ids.push_back({performer.clip, one.at.segment});
    return ids;
}

// In a segment that is on the device, without a frame yet. A coarse tree shows no paint, which refers to leaves.
std::optional<StageClips::Place> StageClips::place_in(const Id& id, const stage::EvaluatedPerformer& performer) const {
    const ClipOnDevice::Segment& segment = at(id);
    const LoadedClip* loaded = drawn(segment);
    if (!loaded) return std::nullopt;
    Place place{&loaded->field};
    place.solid = loaded->solid;
    const uint32_t layers = layers_[performer.performer];
    if (segment.loaded && layers < segment.paints.size()) place.paint = segment.paints[layers].get();
    return place;
}

std::vector<StageClips::Place> StageClips::places_of(const stage::EvaluatedPerformer& performer) const {
    std::vector<Place> places;
    for (const auto& [place, share] : voctree::segment_shares(clips_[performer.clip].index, double{performer.frame}))
        if (std::optional<Place> there = place_in({performer.clip, place.segment}, performer)) {
            there->frame = place.frame;
            there->share = share;
            places.push_back(*there);
        }
    if (places.size() == 1) places[0].share = 1;
    const std::optional<Shown>& last = shown_[performer.performer];
    if (places.empty() && at(wanted_by(performer).id).readable && last && last->id.clip == performer.clip)
        if (std::optional<Place> there = place_in(last->id, performer)) {
            there->frame = last->frame;
            places.push_back(*there);
        }
    return places;
}

bool StageClips::holds(const stage::EvaluatedStage& evaluated) const {
    return std::any_of(evaluated.performers.begin(), evaluated.performers.end(),
                       [this](const stage::EvaluatedPerformer& performer) {
                           const std::vector<Id> ids = segments_of(performer);
                           return performer.visible && at(ids[0]).readable &&
                                  std::ranges::none_of(ids, [this](const Id& id) { return drawn(at(id)); });
                       });
}

bool StageClips::shows_all(const stage::EvaluatedStage& evaluated) const {
    return std::ranges::none_of(needed_at(evaluated), [this](const Id& id) { return is_missing(id); });
}

void StageClips::tell(const Note& problem) {
    if (!problem.empty() && !contains(problems_, problem)) problems_.push_back(problem);
}

void StageClips::tell_lack_of_memory(const Note& problem) {
    if (!std::exchange(told_lack_of_memory_, true)) tell(problem);
}

void StageClips::fail(const Id& id, const Note& problem) {
    at(id).readable = false;
    tell(problem);
}

void StageClips::take(const Id& id, std::shared_ptr<const LoadedClip> loaded, ClipFiles::Paints paints) {
    for (const auto& paint : paints) tell(paint->problem);
    told_lack_of_memory_ = false;
    at(id).loaded = std::move(loaded);
    at(id).paints = std::move(paints);
    on_device_.insert(id);
}

// Takes what the thread has read of files that have not changed since.
void StageClips::take_results() {
    for (const ClipFiles::Result& result : files_->take_results()) {
        const auto found = ids_.find(result.file);
        if (found == ids_.end()) continue;
        const voctree::ClipSegment& file = file_of(found->second[0]);
        if (result.stamp != file.source->stamp(file)) continue;
        for (const Id& id : found->second) {
            ClipOnDevice::Segment& segment = at(id);
            if (segment.loaded) continue;
            if (!result.clip && result.may_come) {  // it is wanted again
                if (result.lacks_memory)
                    lack_of_memory_ = result.problem;
                else
                    tell(result.problem);
                continue;
            }
            if (!result.clip) {
                fail(id, result.problem);
                continue;
            }
            if (!result.is_coarse) {
                // What was wanted for an earlier version of the stage may have other paint: it is wanted again.
                const bool is_same = std::ranges::equal(result.paints, clips_[id.clip].layers,
                                                        [&](const auto& paint, const LayerFolders& layers) {
                                                            return paint->layers == of_segment(layers, file_of(id));
                                                        });
                if (is_same) take(id, result.clip, result.paints);
                continue;
            }
            if (segment.coarse) dropped_.push_back(std::move(segment.coarse));
            segment.coarse = result.clip;
            on_device_.insert(id);
        }
    }
}

// What the performers show at this time.
std::vector<StageClips::Id> StageClips::needed_at(const stage::EvaluatedStage& evaluated) const {
    std::vector<Id> needed;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (!performer.visible || clips_[performer.clip].segments.size() == 1) continue;
        for (const Id& id : segments_of(performer))
            if (!contains(needed, id)) needed.push_back(id);
    }
    return needed;
}

// For how many seconds of the stage what is asked for now of a clip that plays by frame is not there yet, while the
// clock goes on and no image waits for it: frames of which the time is over by then are not worth beginning with.
double StageClips::lead_s(uint32_t clip, MissingSegments missing) const {
    const bool goes_on = goes_on_ && now_s_ - moved_s_ < kStands_s;
    if (!goes_on || missing == MissingSegments::kWait || !clips_[clip].index.plays_by_frame()) return 0;
    return speed_ * files_->pace_of(clips_[clip].index.segments[0])->lead_s();
}

// What the performers show next: what they show when the first that is asked for can be there, then, the earliest
// first, what is there or can be in time.
std::vector<StageClips::Id> StageClips::ahead_of(const stage::Stage& stage, const stage::EvaluatedStage& evaluated,
                                                 MissingSegments missing) const {
    std::vector<double> leads_s;
    std::vector<Id> ahead;
    double step_s = kAheadStep_s, until_s = 0;
    for (uint32_t i = 0; i < clips_.size(); ++i) {
        const ClipOnDevice& clip = clips_[i];
        const bool by_frame = clip.index.plays_by_frame().has_value();
        const double frame_s = 1 / double{clip.index.fps};
        leads_s.push_back(lead_s(i, missing));
        if (by_frame) step_s = std::min(step_s, frame_s);
        // Of frames, no more than there is room for.
        until_s = std::max(until_s, by_frame ? std::min(kAhead_s, leads_s[i] + room_of(clip) * frame_s) : kAhead_s);
    }
    step_s = std::max(step_s, kLeastStep_s);
    const auto add = [&](stage::EvaluatedPerformer performer, double after_s) {
        if (!performer.visible || clips_[performer.clip].segments.size() == 1) return;
        performer.frame = static_cast<float>(
            stage::frame_at(stage.performers[performer.performer].timeline, evaluated.time_s + direction_ * after_s));
        for (const Id& id : segments_of(performer))
            if ((after_s >= leads_s[id.clip] || drawn(at(id))) && !contains(ahead, id)) ahead.push_back(id);
    };
    for (const stage::EvaluatedPerformer& performer : evaluated.performers)
        if (leads_s[performer.clip] > 0) add(performer, leads_s[performer.clip]);
    for (double after_s = step_s; after_s <= until_s; after_s += step_s)
        for (const stage::EvaluatedPerformer& performer : evaluated.performers) add(performer, after_s);
    return ahead;
}

// Of each segmented clip: its first readable segment where that stays, those that are needed or drawn in their place,
// and as many of those ahead and then of those that were shown as there is room for.
std::set<StageClips::Id> StageClips::chosen(const std::vector<Id>& needed, const std::vector<Id>& ahead) const {
    std::set<Id> chosen = first_;
    chosen.insert(needed.begin(), needed.end());
    for (const std::optional<Shown>& last : shown_)
        if (last && std::any_of(needed.begin(), needed.end(), [&](const Id& id) {
                return id.clip == last->id.clip && at(id).readable && !drawn(at(id));
            }))
            chosen.insert(last->id);
    std::vector<uint32_t> room;
    for (const ClipOnDevice& clip : clips_) room.push_back(room_of(clip));
    for (const Id& id : chosen) room[id.clip] -= std::min(room[id.clip], 1u);
    for (uint32_t& one : room) one = std::max(one, kLeastSegmentsAhead);
    for (const std::vector<Id>* list : {&ahead, &recent_})
        for (const Id& id : *list)
            if (room[id.clip] > 0 && at(id).readable && chosen.insert(id).second) --room[id.clip];
    keep_one_frame(chosen);
    return chosen;
}

// Of each stream one frame stays until another is there.
void StageClips::keep_one_frame(std::set<Id>& chosen) const {
    for (uint32_t clip = 0; clip < clips_.size(); ++clip) {
        const auto is_drawn = [&](const Id& id) { return id.clip == clip && drawn(at(id)); };
        if (!clips_[clip].index.plays_by_frame() || std::ranges::any_of(chosen, is_drawn)) continue;
        if (const auto one = std::ranges::find_if(on_device_, is_drawn); one != on_device_.end()) chosen.insert(*one);
    }
}

// Coarse trees of segments that are there as a whole go, too.
void StageClips::drop_all_but(const std::set<Id>& kept) {
    std::erase_if(on_device_, [&](const Id& id) {
        ClipOnDevice::Segment& segment = at(id);
        const bool stays = kept.contains(id);
        if (segment.coarse && (!stays || segment.loaded)) dropped_.push_back(std::exchange(segment.coarse, nullptr));
        if (segment.loaded && !stays) {
            dropped_.push_back(std::exchange(segment.loaded, nullptr));
            segment.paints.clear();
        }
        return !stays || !drawn(segment);
    });
    std::erase_if(recent_, [&](const Id& id) { return !on_device_.contains(id); });
    for (const Id& id : on_device_) {
        ClipOnDevice& clip = clips_[id.clip];
        if (!clip.index.plays_by_frame()) continue;
        clip.first = at(id).loaded ? at(id).loaded : at(id).coarse;  // each is drawn, or it would not be on the device
    }
}

// Frames of a stream may come later than they are due. Then performers show the one that came, where it is nearer to
// their time than what they show, but not one that is still to come.
void StageClips::show_late_frames(const stage::EvaluatedStage& evaluated) {
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (!performer.visible || !clips_[performer.clip].index.plays_by_frame()) continue;
        const Id wanted = wanted_by(performer).id;
        const auto away = [&](const Id& id) { return std::abs(int64_t{id.segment} - int64_t{wanted.segment}); };
        const auto is_to_come = [&](const Id& id) {
            return direction_ > 0 ? id.segment > wanted.segment : id.segment < wanted.segment;
        };
        std::optional<Shown>& shown = shown_[performer.performer];
        for (const Id& id : on_device_)
            if (id.clip == wanted.clip && !is_to_come(id) &&
                (!shown || shown->id.clip != id.clip || away(id) < away(shown->id)))
                shown = Shown{id, 0};
    }
}

// Notes what performers show now, for when a segment is missing.
void StageClips::remember(const stage::EvaluatedStage& evaluated) {
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (!performer.visible || clips_[performer.clip].segments.size() == 1) continue;
        bool is_first = true;
        for (const auto& [place, share] :
             voctree::segment_shares(clips_[performer.clip].index, double{performer.frame})) {
            const Id id{performer.clip, place.segment};
            if (!drawn(at(id))) continue;
            if (is_first) shown_[performer.performer] = Shown{id, place.frame};
            is_first = false;
            std::erase(recent_, id);
            recent_.insert(recent_.begin(), id);
        }
    }
}

// Notes since when what performers show now has been needed without a break.
void StageClips::note_needed(const std::vector<Id>& needed) {
    std::map<Id, double> since;
    for (const Id& id : needed) {
        const auto before = needed_since_s_.find(id);
        since[id] = before == needed_since_s_.end() ? now_s_ : before->second;
    }
    needed_since_s_ = std::move(since);
}

// What is wanted of the threads: first what performers show, then what is ahead, last what comes too late. Of a frame
// of a stream, what comes in time is enough while performers move; of one that is shown for longer, the rest is wanted,
// too.
std::vector<ClipFiles::Wanted> StageClips::wanted_of(const std::vector<Id>& needed, const std::vector<Id>& ahead,
                                                     const std::set<Id>& kept, MissingSegments missing) const {
    const auto stands = [&](const Id& id) { return now_s_ - needed_since_s_.at(id) >= kStands_s; };
    const bool all_stand = std::ranges::all_of(needed, stands);
    std::vector<ClipFiles::Wanted> wanted;
    const auto add = [&](const Id& id, bool is_urgent, bool in_time) {
        in_time = in_time && missing == MissingSegments::kHold;
        const bool is_enough = in_time && at(id).coarse && clips_[id.clip].index.plays_by_frame();
        if (is_missing(id) && !is_enough) wanted.push_back({file_of(id), is_urgent, clips_[id.clip].layers, in_time});
    };
    const auto is_late = [&](const Id& id) { return lead_s(id.clip, missing) > 0 && !contains(ahead, id); };
    for (const Id& id : needed)
        if (!is_late(id)) add(id, !at(id).coarse, !stands(id));
    for (const Id& id : ahead)
        if (kept.contains(id) && !contains(needed, id)) add(id, false, !all_stand);
    for (const Id& id : needed)
        if (is_late(id)) add(id, false, !stands(id));
    return wanted;
}

// A clock goes on that moves shortly after it moved or jumped: a single step is none.
void StageClips::note_clock(double time_s) {
    constexpr double kNewSpeed = 0.3, kLeastSpeed = 0.1, kMostSpeed = 4;
    const double step_s = time_s - std::exchange(last_s_, time_s);
    if (step_s == 0) return;
    const double since_s = now_s_ - std::exchange(moved_s_, now_s_);
    goes_on_ = std::abs(step_s) < kJump_s && since_s < kStands_s;
    if (std::abs(step_s) >= kJump_s) return;
    direction_ = step_s < 0 ? -1 : 1;
    if (goes_on_ && since_s > 0)
        speed_ = std::clamp(speed_ + kNewSpeed * (std::abs(step_s) / since_s - speed_), kLeastSpeed, kMostSpeed);
}

void StageClips::follow(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, MissingSegments missing,
                        double now_s) {
    if (ids_.empty()) return;
    now_s_ = now_s;
    note_clock(evaluated.time_s);
    take_results();
    show_late_frames(evaluated);
    const std::vector<Id> needed = needed_at(evaluated), ahead = ahead_of(stage, evaluated, missing);
    const std::set<Id> kept = chosen(needed, ahead);
    drop_all_but(kept);
    remember(evaluated);
    note_needed(needed);
    files_->read_ahead(wanted_of(needed, ahead, kept, missing));
}

void StageClips::read_missing(const stage::EvaluatedStage& evaluated) {
    for (const Id& id : needed_at(evaluated)) {
        if (!is_missing(id)) continue;
        try {
            const std::shared_ptr<const LoadedClip> loaded = files_->read(file_of(id));
            take(id, loaded, files_->read_paints(file_of(id), *loaded, clips_[id.clip].layers));
        } catch (const stream::ServerProblem& problem) {
            tell(Note(problem));
        } catch (const InputError& problem) {
            fail(id, Note(problem));
        }
    }
    remember(evaluated);
}

}  // namespace neuvv::render
