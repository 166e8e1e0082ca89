// Coach: compares a trainee with the trainer of a clip while it plays, and says what to show.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coach/ghost.h"
#include "coach/viewpoint.h"
#include "motion/live/live.h"
#include "motion/live/pose_line.h"

namespace neuvv::coach {

enum class Mode {
    kWatch,    // the clip plays; nothing is compared
    kFollow,   // the clip slows down where the trainee does not keep up
    kPerform,  // the clip plays at its speed, and the performance is recorded for a report
};
constexpr const char* kModeNames[] = {"watch", "follow", "perform"};

struct CoachSettings {
    Mode mode = Mode::kFollow;
    bool mirrored = false;  // the trainee does with the left what the trainer does with the right
    double speed = 1;       // of the clip where nothing slows it down
    bool ghost = true, arrows = true;
    motion::CompareOptions compare;  // which limbs count, and their tolerances
};

class Coach {
  public:
    // The trainer's skeleton is in the performer's space, and has a frame (assert).
    Coach(motion::SkeletonClip trainer, CoachSettings settings);
    Coach(const Coach&) = delete;
    Coach& operator=(const Coach&) = delete;

    // To be called for each image: the clip shows clip_s, and `pose` has arrived since the last call. Both clocks are
    // in seconds; where the clip jumped, the comparison begins anew, and its score goes on. Without a pose for a second
    // nothing is red.
    void update(const std::optional<motion::TimedPose>& pose, double now_s, double clip_s);

    // How fast the clip should play now: settings().speed, or less in Mode::kFollow while a limb is wrong or late.
    double clip_speed() const;

    // Of the time of the last update. The space is the performer's, metres.
    const motion::Feedback& feedback() const { return live_->feedback(); }
    motion::Pose shown() const;  // of the trainer
    glm::dvec3 centre() const;   // of the trainer: what a view looks at
    std::vector<BodyBone> body() const;
    LimbValues red() const;
    // Null where nothing is red.
    std::shared_ptr<const render::Highlight> highlight() const;
    // Nothing where the trainee was not seen for a second, or in Mode::kWatch.
    std::optional<motion::Pose> ghost() const;
    std::vector<JointError> errors() const;
    // "left arm: 25° off", one for each red limb.
    std::vector<std::string> remarks() const;
    // From where the errors are seen best; nothing as long as there was none.
    std::optional<glm::dvec3> best_eye() const { return best_eye_; }
    // Where to begin again to repeat the last mistake: a second before it, clip time; nothing where there was none.
    std::optional<double> last_mistake_s() const;

    // What was recorded in Mode::kPerform, at the trainer's rate from the clip's beginning: the last performance of
    // nearly the whole clip that the clip's next round has ended, else the one that is under way; empty: nothing.
    // Joints are unknown in frames that nobody performed.
    const motion::SkeletonClip& recorded() const { return performed_.frames.empty() ? recorded_ : performed_; }
    // The trainer in the same frames, to compare with.
    motion::SkeletonClip shown_to_recorded() const;
    const motion::SkeletonClip& trainer() const { return trainer_; }
    double height() const { return height_; }  // of the trainer, metres

    const CoachSettings& settings() const { return settings_; }
    // Changed limbs and tolerances begin the comparison and its score anew.
    void change(const CoachSettings& settings);

  private:
    bool compares() const;
    void begin_record();
    void record(double clip_s);
    void note_mistakes(double clip_s);
    void choose_view(double step_s);
    motion::SkeletonClip trainer_;
    double height_ = 0;
    CoachSettings settings_;
    std::unique_ptr<motion::LiveComparison> live_;
    std::optional<motion::TimedPose> trainee_;  // the newest
    motion::SkeletonClip recorded_, performed_;
    std::array<bool, motion::kLimbs> was_wrong_{};
    std::optional<double> last_mistake_s_;  // when a limb last turned wrong, clip time
    size_t performed_frames_ = 0;           // of recorded_: those in which the trainee was seen
    ViewChooser chooser_;
    std::optional<glm::dvec3> best_eye_;
    double now_s_ = 0, clip_s_ = -1;
};

// Whether a clip has jumped between two images: by more than half a second, or back by a frame of the skeleton. A clock
// that changes its speed divides frames anew, and may show a part of one again.
constexpr double kJump_s = 0.5;
inline bool has_jumped(double before_s, double now_s, double frame_s) {
    return now_s <= before_s - 0.999 * frame_s || now_s > before_s + kJump_s;
}
// The distance, in heights of the body, from which a trainer is looked at.
constexpr double kViewDistance = 1.6;

}  // namespace neuvv::coach
