// Stage clips: which segments of a stage's clips are on the device. Those that performers show are, and some that the
// stage's clock comes to next, so that neither memory nor the time of an image grows with the length of a clip.
#pragma once

#include <optional>
#include <set>

#include "render/stage_assets.h"
#include "stage/evaluated_stage.h"

namespace neuvv::render {

// What happens where a performer shows a segment that is not on the device.
enum class MissingSegments {
    kWait,  // it is read before the image is drawn
    kHold,  // the performer stays as it was shown last, until a thread has read the segment: no image waits for a disk
};

// Segments of a segmented clip that are on the device at once, unless its performers show more of them.
constexpr uint32_t kSegmentsOnDevice = 5;

class StageClips {
  public:
    StageClips() = default;
    explicit StageClips(const StageAssets& assets);

    struct Changes {
        bool any = false;
        // What is no longer among fields(). The renderer's fields must be replaced before this is destroyed.
        std::vector<std::shared_ptr<const LoadedClip>> dropped;
    };
    // Follows the stage, which the assets are of, to a time. Throws RuntimeFailure where the device has no memory.
    Changes follow(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, MissingSegments missing);

    // The fields of all segments that are on the device. A file that several clips play is one field.
    std::vector<const Field*> fields() const;
    // The largest number of fields, unless performers show more of them at once.
    uint32_t max_fields() const;

    // Where a performer is in its clip. Nothing where its segment cannot be read, or is held and was not shown before.
    struct Place {
        const Field* field = nullptr;
        float frame = 0;  // of that field
    };
    std::optional<Place> place_of(const stage::EvaluatedPerformer& performer) const;

    // Whether follow() left a visible performer as it was shown before, or undrawn, because its segment is not read
    // yet.
    bool holds() const { return holds_; }

    const std::vector<ClipOnDevice>& clips() const { return clips_; }
    // A line for each segment of which it is known that it cannot be read; at its times, the performer is not there.
    const std::vector<std::string>& problems() const { return problems_; }

  private:
    struct Id {
        uint32_t clip = 0, segment = 0;
        auto operator<=>(const Id&) const = default;
    };
    struct Shown {
        Id id;
        float frame = 0;
    };
    ClipOnDevice::Segment& at(const Id& id) { return clips_[id.clip].segments[id.segment]; }
    const ClipOnDevice::Segment& at(const Id& id) const { return clips_[id.clip].segments[id.segment]; }
    Shown wanted_by(const stage::EvaluatedPerformer& performer) const;
    bool take_results();
    void fail(Id id, const std::string& problem);
    bool read_now(Id id);
    std::vector<Id> needed_at(const stage::EvaluatedStage& evaluated) const;
    std::vector<Id> ahead_of(const stage::Stage& stage, const stage::EvaluatedStage& evaluated) const;
    std::set<Id> chosen(const std::vector<Id>& needed, const std::vector<Id>& ahead) const;
    void remember(const stage::EvaluatedStage& evaluated);
    std::vector<ClipOnDevice> clips_;
    std::shared_ptr<ClipFiles> files_;
    std::vector<std::string> problems_;
    bool segmented_ = false, holds_ = false;   // segmented: any clip is
    std::vector<std::optional<Shown>> shown_;  // by performer: what it showed last, of a segmented clip
    std::vector<Id> recent_;                   // segments that were shown and are on the device, the newest first
    std::vector<Id> requested_;                // what the thread was asked for last
    double last_s_ = 0, direction_ = 1;        // of the stage's clock: 1 or −1
};

}  // namespace neuvv::render
