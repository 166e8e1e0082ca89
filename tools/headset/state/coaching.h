// The user performs along with a performer of the stage, the trainer: the session, what the panel sets of it, and the
// temporary turn of the trainer. Nothing here changes the document.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "base/threads/job_queue.h"
#include "coach/session.h"
#include "tools/headset/state/headset_state.h"
#include "xr/draw/eye_shapes.h"

namespace neuvv::headset {

// A turn of a performer about its own vertical axis, beside the transform that the stage gives it.
class TrainerTurn {
  public:
    static constexpr double kTurn_s = 0.5;

    // Begins to turn the performer so that somebody at `head` will see the side that faces `eye`. The axis goes through
    // `centre`. All are in the performer's space as it is drawn now. Nothing happens where either is above or below the
    // centre.
    void show(const glm::dvec3& centre, const glm::dvec3& eye, const glm::dvec3& head);
    void advance(double dt_s) { passed_s_ += dt_s; }
    // The turn as it is now: the transform from the turned performer's space to the one that the stage gives it.
    glm::dmat4 performer_from_turned() const;
    double angle_rad() const;  // about +Y, −π to π

  private:
    glm::dmat4 from_{1};  // the turn when the present one began
    glm::dvec3 centre_{0};
    double by_rad_ = 0, passed_s_ = kTurn_s;
};

class Coaching {
  public:
    // `jobs` must outlive this object, or be stopped before it is destroyed.
    explicit Coaching(JobQueue& jobs) : jobs_(jobs) {}

    // Begins with the selected performer, or, where none is selected, the first that has a skeleton, and plays. A job
    // reads the skeleton; a notice says what is wrong with it. Poses come from the source of the session before, if
    // that had one.
    void begin(HeadsetState& state);
    // Begins at once. Poses come from `source`, or, where it is null, with update().
    void begin(HeadsetState& state, coach::Trainer trainer, std::unique_ptr<motion::PoseSource> source);
    // The clock has its own speed again, and the trainer is not turned any more.
    void end(HeadsetState& state);
    bool is_running() const { return session_.is_running(); }
    // Whether update() needs the wearer's body.
    bool needs_body() const { return is_running() && !session_.source(); }

    // To be called in each frame after HeadsetState::evaluate: turns the trainer in `state.evaluated`.
    void turn_trainer(HeadsetState& state, double dt_s);
    // To be called when the evaluated stage is as it will be drawn: compares, and sets the speed of the clock while it
    // plays. `body` and `head` are the wearer's, in the world, metres.
    void update(HeadsetState& state, const std::optional<motion::Pose>& body, const glm::dvec3& head);

    // Sets the clock to a second before the last mistake, and plays.
    void repeat_mistake(HeadsetState& state);
    // Turns the trainer so that the wearer sees it from where the errors are seen best.
    void show_best_view();

    const coach::Session& session() const { return session_; }
    const TrainerTurn& turn() const { return turn_; }
    // For the program's report; null where no session runs.
    nlohmann::json facts() const;

    coach::CoachSettings settings;  // of the session, and of the next one

  private:
    JobQueue& jobs_;
    coach::Session session_;
    std::unique_ptr<motion::PoseSource> source_;  // of the last session, between sessions
    TrainerTurn turn_;
    glm::dvec3 head_{0};    // world, at the last update
    double now_s_ = 0;      // the session's clock: the display's time, without pauses of the program
    double own_speed_ = 1;  // of the stage's clock, before the session
};

// Ghost and arrows, over everything else.
void draw_guide(xr::EyeShapes& shapes, const std::vector<coach::GuideLine>& lines);

}  // namespace neuvv::headset
