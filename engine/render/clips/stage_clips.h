// Stage clips: which segments of a stage's clips are on the device. Those that performers show are, and some that the
// stage's clock comes to next, so that memory does not grow with the length of a clip.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/seconds.h"
#include "render/clips/stage_assets.h"
#include "stage/evaluated_stage.h"

namespace neuvv::render {

// What happens where a performer shows a segment that is not on the device.
enum class MissingSegments {
    kWait,  // it is read before the image is drawn
    // The performer stays as it was shown last until a thread has read the segment's coarse tree, which it shows until
    // the whole one is there, or a frame of a stream that is nearer to its time: no image waits for a disk.
    kHold,
};

// Segments of a segmented clip that are on the device at once, and frames of a stream: as many of the largest as take
// so many bytes, between a least and a most number. Where performers show more than all but two of them, two more than
// those.
constexpr uint32_t kSegmentsOnDevice = 5, kLeastStreamFrames = 4, kMostStreamFrames = 10, kLeastSegmentsAhead = 2;
constexpr uint64_t kStreamBytesOnDevice = uint64_t{96} << 20;

// Whoever draws fields() must call follow(), then draw the fields that there are now, and then call free_dropped().
class StageClips {
  public:
    StageClips() = default;
    explicit StageClips(const StageAssets& assets);

    // Takes over the clock, and what performers showed, from the clips of an earlier version of the stage.
    void go_on_from(const StageClips& before);

    // Follows the stage, which the assets are of, to a time: takes what the thread has read, drops what is far from
    // this time, and has the thread read what is missing. `now_s`: of a clock that never goes back, which says how long
    // the stage stands at a time.
    void follow(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, MissingSegments missing,
                double now_s = seconds_now());
    // Reads what performers show at this time and is not there. Throws RuntimeFailure where the device has no memory.
    void read_missing(const stage::EvaluatedStage& evaluated);
    // Frees what follow() has dropped, which must not be drawn any more.
    void free_dropped() { dropped_.clear(); }

    // The fields of all segments that are on the device, or coarse trees in their place. A file that several clips play
    // is one field.
    std::vector<const Field*> fields() const;
    // The largest number of fields whose slices are built, which those of streams are not, unless performers show many
    // segments at once.
    uint32_t usual_fields() const;

    // A place in the field of a segment.
    struct Place {
        const Field* field = nullptr;
        float frame = 0;                                      // of that field
        float share = 1;                                      // of the density
        const SegmentPaint* paint = nullptr;                  // of a performer on a segmented clip that has layers
        std::shared_ptr<const voctree::SolidLeaves> solid{};  // of the segment
    };
    // Where a performer is drawn: in the segment of its time, and while that fades into another, in both
    // (segment_shares), the first one first. Where only one of two is on the device, it is drawn alone; where none is,
    // what was shown last. Empty where the segment cannot be read, or is held and nothing was shown before.
    std::vector<Place> places_of(const stage::EvaluatedPerformer& performer) const;

    // Whether a performer that is visible at this time is held, because nothing of its segments is read yet.
    bool holds(const stage::EvaluatedStage& evaluated) const;
    // Whether all that visible performers show at this time is there as a whole, but for what cannot be read.
    bool shows_all(const stage::EvaluatedStage& evaluated) const;

    const std::vector<ClipOnDevice>& clips() const { return clips_; }
    // Calls each(segment) for the segments of segmented clips that are on the device.
    void for_segments(const auto& each) const {
        for (const Id& id : on_device_) each(at(id));
    }
    // A line for each segment of which it is known that it cannot be read; at its times, the performer is not there.
    // And one for paint of a segment that cannot be read and does not show.
    const std::vector<Note>& problems() const { return problems_; }
    void tell(const Note& problem);
    // The same for a lack of memory, of which each attempt has another text: once, until something was read.
    void tell_lack_of_memory(const Note& problem);
    // Why a segment could not be read for want of memory since the last call; empty: there was memory for all. It is
    // none of the problems: whoever can free memory does so, and else calls tell().
    Note take_lack_of_memory() { return std::exchange(lack_of_memory_, {}); }

  private:
    struct Id {
        uint32_t clip = 0, segment = 0;
        auto operator<=>(const Id&) const = default;
    };
    struct Shown {
        Id id;
        float frame = 0;
    };
    std::optional<Place> place_in(const Id& id, const stage::EvaluatedPerformer& performer) const;
    ClipOnDevice::Segment& at(const Id& id) { return clips_[id.clip].segments[id.segment]; }
    const ClipOnDevice::Segment& at(const Id& id) const { return clips_[id.clip].segments[id.segment]; }
    const voctree::ClipSegment& file_of(const Id& id) const { return clips_[id.clip].index.segments[id.segment]; }
    Shown wanted_by(const stage::EvaluatedPerformer& performer) const;
    std::vector<Id> segments_of(const stage::EvaluatedPerformer& performer) const;
    double lead_s(uint32_t clip, MissingSegments missing) const;
    bool is_missing(const Id& id) const { return at(id).readable && !at(id).loaded; }
    void note_clock(double time_s);
    void take_results();
    void fail(const Id& id, const Note& problem);
    void take(const Id& id, std::shared_ptr<const LoadedClip> loaded, ClipFiles::Paints paints);
    std::vector<Id> needed_at(const stage::EvaluatedStage& evaluated) const;
    std::vector<Id> ahead_of(const stage::Stage& stage, const stage::EvaluatedStage& evaluated,
                             MissingSegments missing) const;
    std::set<Id> chosen(const std::vector<Id>& needed, const std::vector<Id>& ahead) const;
    void keep_one_frame(std::set<Id>& chosen) const;
    void drop_all_but(const std::set<Id>& kept);
    void show_late_frames(const stage::EvaluatedStage& evaluated);
    void note_needed(const std::vector<Id>& needed);
    std::vector<ClipFiles::Wanted> wanted_of(const std::vector<Id>& needed, const std::vector<Id>& ahead,
                                             const std::set<Id>& kept, MissingSegments missing) const;
    void remember(const stage::EvaluatedStage& evaluated);
    std::vector<ClipOnDevice> clips_;
    std::vector<uint32_t> layers_;  // by performer: an index into ClipOnDevice::layers (StageAssets)
    std::shared_ptr<ClipFiles> files_;
    std::vector<Note> problems_;
    Note lack_of_memory_;
    bool told_lack_of_memory_ = false;  // since something was read
    // Of segmented clips only:
    std::map<std::filesystem::path, std::vector<Id>> ids_;  // by file
    std::set<Id> first_;                                    // the one of each that stays; none of a stream
    std::set<Id> on_device_;                                // those with a loaded or a coarse tree
    std::vector<std::optional<Shown>> shown_;               // by performer: what it showed last
    std::vector<Id> recent_;                                // what was shown and is on the device, the newest first
    std::vector<std::shared_ptr<const LoadedClip>> dropped_;
    double now_s_ = 0;                     // of the last follow()
    std::map<Id, double> needed_since_s_;  // by the same clock, of what performers show
    double last_s_ = 0, direction_ = 1;    // of the stage's clock: 1 or −1
    double moved_s_ = 0;                   // by the same clock: when it moved last
    bool goes_on_ = false;                 // whether it did not jump then, and had moved shortly before
    double speed_ = 1;                     // of the stage's seconds a real one, as it goes on
};

}  // namespace neuvv::render
