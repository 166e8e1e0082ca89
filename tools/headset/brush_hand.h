// Painting in the air: a ball or a box at the tip of a hand colours or erases what of the selected performer it
// touches; a box that is pulled up from corner to corner chooses a region for the panel's buttons.
//
// Leaves are looked for and layers made on the thread for files, so that no frame waits: what a stroke touches
// meanwhile follows with the next job, and a stroke that is begun while another is laid, or while its performer is
// read, follows that.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/job_queue.h"
#include "editor/paint_session.h"
#include "tools/headset/hand.h"
#include "tools/headset/on_stage.h"

namespace neuvv::headset {

// In the performer's space, metres.
struct PaintRegion {
    uint32_t node = 0;
    size_t nodes = 0;  // of the document: with another number of them it may mean another one
    glm::dvec3 low{0}, high{0};
};

class BrushHand {
  public:
    // `jobs` must outlive it, or be stopped before.
    explicit BrushHand(JobQueue& jobs) : jobs_(jobs) {}

    void update(OnStage& on, Hands& hands);
    // The hand ends its stroke: one step of the history; what is still being laid comes into it.
    void end_stroke(OnStage& on);
    // The first stroke goes on, where it can: update() does it, and jobs that end.
    void lay(OnStage& on);
    // Whether strokes are drawn, are being laid, or wait to be: numbers of nodes must not change meanwhile.
    bool busy() const { return !strokes_.empty(); }

    const std::optional<PaintRegion>& region() const { return region_; }
    void forget_region() { region_.reset(); }
    // Colours or erases what is in it, as the brush is set.
    void do_region(OnStage& on);

    // The tip of a hand that paints: world.
    static glm::dvec3 tip_of(const xr::Pose& world_aim);
    // "Paints anna, on its layer \"stars\"", "Reading anna, to be painted"; empty: nobody is to be painted.
    const std::string& says() const { return says_; }

  private:
    struct Ready;
    struct Stroke;
    std::optional<uint32_t> target(const OnStage& on);
    std::shared_ptr<const Ready> prepare(OnStage& on, uint32_t performer);
    void say_what_is_painted(const OnStage& on, const Ready& ready);
    std::shared_ptr<Stroke> begin(const OnStage& on, uint32_t performer) const;
    void draw(OnStage& on, const Hand& hand);
    void lay_more(OnStage& on, std::shared_ptr<Stroke> stroke);
    void finish(OnStage& on);
    void pull_region(const OnStage& on, uint32_t performer, Hand& hand);

    JobQueue& jobs_;
    std::shared_ptr<const Ready> ready_;  // what is known of the performer that is painted
    // The first is being laid, once its performer has been read; the last is the hand's until it is released.
    std::deque<std::shared_ptr<Stroke>> strokes_;
    struct Failed {
        uint64_t id = 0;  // of the document
        uint32_t node = 0;
        std::string problem;
    } failed_;  // what cannot be read
    bool reading_ = false;
    std::string says_;
    std::optional<PaintRegion> region_;
    std::optional<glm::dvec3> corner_;  // the region's first, performer's space, while it is pulled
};

}  // namespace neuvv::headset
