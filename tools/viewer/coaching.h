// Somebody performs along with a performer of the stage: the session, and what the tab "Coach" sets.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "coach/session.h"
#include "tools/viewer/context.h"

namespace neuvv::viewer {

class Coaching {
  public:
    // Begins with the selected performer, or, where none is selected, the first that has a skeleton. The skeleton is
    // read by a job; a notice says what is wrong with it or with the address. Poses come from `address`
    // (motion::open_pose_source).
    void begin(Context& context);
    // Begins as soon as there is a stage.
    void begin_with_stage(const std::string& from) {
        address = from;
        awaits_stage_ = true;
    }
    // The clock has its own speed again.
    void end(Context& context);
    bool is_running() const { return session_.is_running(); }

    // Once a frame, after the stage was evaluated: compares, and sets the speed of the clock.
    void tick(Context& context);
    // Draws ghost and arrows over the image.
    void draw(const Context& context) const;

    // Sets the clock to a second before the last mistake, and plays.
    void repeat_mistake(Context& context);
    // Lets the eye fly to where the errors are seen best.
    void show_best_view(Context& context) const;
    // Writes an HTML page about the recorded performance beside the stage.
    void write_report(Context& context) const;

    const coach::Session& session() const { return session_; }
    // For the viewer's report.
    nlohmann::json facts() const;

    std::string address = "vmc";
    coach::CoachSettings settings;  // of the session, and of the next one

  private:
    coach::Session session_;
    double own_speed_ = 1;  // of the clock, before the session
    bool awaits_stage_ = false, begins_ = false;
    render::PerformerHighlight shown_;  // in the last frame
    uint64_t opened_ = 0;               // Editor::open_count of the session's stage
};

}  // namespace neuvv::viewer
