// Painting in the air: a ball or a box at the tip of the hand that paints, or where its ray meets the performer,
// colours or erases those leaves of the selected performer that it touches. With the region tool, the hand drags a box
// from corner to corner, which the panel's buttons colour or erase. With an image, each press projects it along the
// hand's ray onto the performer. The hand that paints is the right one; for left-handed users the left one.
//
// The leaves are searched, and layers made, by the job queue, so that no frame waits. What a stroke touches while a job
// runs is done by the next job. A stroke that begins while another one is still being applied, or while its performer
// is being read, waits for that.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "base/threads/job_queue.h"
#include "editor/paint/paint_session.h"
#include "editor/paint/paint_spread.h"
#include "tools/headset/state/hand.h"
#include "tools/headset/state/headset_state.h"

namespace neuvv::headset {

// A box in the space of a performer, metres.
struct PaintRegion {
    uint32_t node = 0;      // of the performer
    size_t node_count = 0;  // of the document: when it changes, `node` may be another node
    glm::dvec3 low{0}, high{0};
};

// Projects an image onto a performer as it is drawn: a session with the projection, for the file of a clip or segment.
// Nullopt where that is not on the device. Only a device can do it, so it is given from outside; it waits for the
// device. It may throw RuntimeFailure; that the device is lost is thrown on.
using ProjectImage = std::function<std::optional<editor::PaintSession>(
    const std::filesystem::path& file, editor::PaintSubject subject, editor::Layer before,
    const editor::PaintOperation& operation, editor::PaintArea area)>;

class HandPainter {
  public:
    ProjectImage project_image;  // empty while there is no device

    // `jobs` must outlive this object, or be stopped before it is destroyed.
    explicit HandPainter(JobQueue& jobs) : jobs_(jobs) {}

    // Begins, extends and ends strokes or drags the region, by the selected tool and the hand that paints.
    void update(HeadsetState& state, Hands& hands);
    // Ends the stroke of the hand. A stroke is one step of the history, including what is still being applied of it.
    void end_stroke(HeadsetState& state);
    // Continues with the oldest stroke, where that is possible: starts its next job or finishes it; and with painting
    // other segments. update() calls it, and so do the jobs when they end.
    void process_strokes(HeadsetState& state);
    // Whether any stroke is unfinished. Until then, the numbers of nodes must not change.
    bool is_busy() const { return !strokes_.empty(); }
    // The same, or whether other segments of a clip are still being painted.
    bool is_at_work() const { return is_busy() || (spreads_ && !spreads_->is_idle()); }

    // The height of the image that the brush projects, as a share of its width; 1 where it is not known yet.
    double image_height() const { return image_ ? 1.0 * image_->height / image_->width : 1; }
    const std::optional<PaintRegion>& region() const { return region_; }
    void clear_region() { region_.reset(); }
    // Colours or erases all leaves in the region, as the brush is set.
    void apply_region(HeadsetState& state);

    // The tip of a hand in the world.
    static glm::dvec3 tip_of(const xr::Pose& world_aim);
    // Where the brush is in the world; nullopt where it paints by the ray, and the ray meets no surface.
    static std::optional<glm::dvec3> brush_at(const HeadsetState& state, const Hand& hand);
    // A line for the user: "Paints anna, on its layer \"stars\"", "Reading anna, to be painted"; empty where there is
    // nothing to paint.
    const std::string& status() const { return status_; }

  private:
    struct PaintTarget;
    struct Stroke;
    std::optional<uint32_t> performer_to_paint(const HeadsetState& state);
    std::shared_ptr<const PaintTarget> load_target(HeadsetState& state, uint32_t performer, float frame);
    void update_status(const HeadsetState& state, const PaintTarget& target);
    std::shared_ptr<Stroke> begin_stroke(const HeadsetState& state, uint32_t performer) const;
    void extend_stroke(HeadsetState& state, const Hand& hand);
    static void pick_colour(HeadsetState& state, Hand& hand);
    void read_image(HeadsetState& state);
    void put_image(HeadsetState& state, uint32_t performer, Hand& hand);
    void begin_session(HeadsetState& state, Stroke& stroke);
    static editor::Layer painted(Stroke& stroke, const edit::Region& touched);
    void start_job(HeadsetState& state, std::shared_ptr<Stroke> stroke);
    void finish_stroke(HeadsetState& state);
    void drag_region(const HeadsetState& state, uint32_t performer, Hand& hand);

    JobQueue& jobs_;
    std::shared_ptr<const PaintTarget> target_;  // the one that was read last
    // From the oldest on, which is being applied once its performer has been read. The last one belongs to the hand
    // until it is released.
    std::deque<std::shared_ptr<Stroke>> strokes_;
    struct FailedTarget {
        uint64_t id = 0;  // of the document
        uint32_t node = 0;
        std::filesystem::path file;  // of the clip
        std::string problem;
    } failed_target_;  // the last one that could not be read; it is not tried again until the document changes
    std::optional<editor::PaintSpreads> spreads_;  // from the first one on
    bool reading_ = false;
    std::filesystem::path image_file_;           // that was read last, or is being read
    std::shared_ptr<const media::Image> image_;  // null: not yet, or it could not be read
    bool image_failed_ = false;                  // it could not be read
    std::string status_;
    std::optional<PaintRegion> region_;
    std::optional<glm::dvec3> corner_;  // performer's space: where the drag of the region began, while it lasts
};

}  // namespace neuvv::headset
