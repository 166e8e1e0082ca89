// A session: somebody performs along with a performer of an open stage, which may be edited meanwhile.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "coach/coach.h"
#include "coach/guide.h"
#include "coach/trainer.h"
#include "motion/live/pose_source.h"

namespace neuvv::coach {

class Session {
  public:
    // Begins with what read_trainer returned. Poses come from `source`, or, where it is null, with update(). With a
    // recorded motion, Mode::kFollow becomes kPerform.
    void begin(Trainer trainer, std::unique_ptr<motion::PoseSource> source, const CoachSettings& settings);
    // Returns the source, which goes on listening for the next session; null where there is none.
    std::unique_ptr<motion::PoseSource> end();
    bool is_running() const { return coach_ != nullptr; }

    // To be called for each image, with the stage that is displayed. `now_s` is the caller's clock in seconds. `body`
    // is the trainee as a headset sees it, in world metres, where there is no source. Does nothing where no session
    // runs. While the stage has no performer of the trainer's name, nothing is compared.
    void update(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, double now_s,
                const std::optional<motion::TimedPose>& body = {});

    // Only while a session runs.
    Coach& coach() { return *coach_; }
    const Coach& coach() const { return *coach_; }
    const std::string& trainer_name() const { return name_; }
    const motion::PoseSource* source() const { return source_.get(); }

    // The highlight for StageRenderer::settings_at; none where no session runs.
    render::PerformerHighlight highlight() const;
    // Ghost and arrows in the world.
    std::vector<GuideLine> guide() const;
    // Of the trainer, at the last update.
    const glm::dmat4& world_from_performer() const { return world_from_performer_; }
    // From where the errors are seen best, and the point to look at; world metres.
    struct View {
        glm::dvec3 eye{0}, target{0};
    };
    std::optional<View> best_view() const;
    // The stage time at which the clip shows clip_s, the nearest to stage_s within the stage; nothing where the clip
    // never does.
    std::optional<double> stage_time_of(const stage::Stage& stage, double clip_s, double stage_s) const;

    // Trainer, score, red limbs and remarks, for tests of the window and the headset. Only while a session runs.
    nlohmann::json facts() const;

    // What became of the source since the last call, for the user: "the trainee's motion has stopped".
    std::vector<std::string> take_notices();

  private:
    void follow_clip(double now_s, double clip_s);
    void note_source();
    std::string name_;
    std::unique_ptr<motion::PoseSource> source_;
    std::unique_ptr<Coach> coach_;
    std::optional<uint32_t> performer_;  // of the displayed stage
    glm::dmat4 world_from_performer_{1};
    std::optional<double> clip_s_;  // at the last update
    double moved_s_ = 0;            // when the clip last moved
    bool was_stopped_ = false, said_error_ = false;
    std::vector<std::string> notices_;
};

}  // namespace neuvv::coach
