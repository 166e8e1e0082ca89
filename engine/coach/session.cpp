#include "coach/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace neuvv::coach {

void Session::begin(Trainer trainer, std::unique_ptr<motion::PoseSource> source, const CoachSettings& settings) {
    // A recorded trainee does not wait for a clip that waits for it.
    CoachSettings begun = settings;
    if (source && source->is_recorded() && begun.mode == Mode::kFollow) begun.mode = Mode::kPerform;
    coach_ = std::make_unique<Coach>(std::move(trainer.skeleton), begun);
    name_ = trainer.name;
    source_ = std::move(source);
    performer_ = trainer.performer;
    clip_s_.reset();
    was_stopped_ = said_error_ = false;
}

std::unique_ptr<motion::PoseSource> Session::end() {
    coach_.reset();
    performer_.reset();
    return std::move(source_);
}

void Session::update(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, double now_s,
                     const std::optional<motion::TimedPose>& body) {
    if (!coach_) return;
    const auto found = std::ranges::find(stage.performers, name_, &stage::StagePerformer::name);
    performer_.reset();
    if (found == stage.performers.end()) return;
    performer_ = static_cast<uint32_t>(found - stage.performers.begin());
    const stage::EvaluatedPerformer& performer = evaluated.performers[*performer_];
    world_from_performer_ = performer.world_from_performer;
    const double clip_s = clip_time_of(stage, performer);
    follow_clip(now_s, clip_s);
    coach_->update(source_ ? source_->newest(now_s) : body, now_s, clip_s);
    if (source_) note_source();
}

// A recorded trainee jumps with the clip, and goes on with it after a pause.
void Session::follow_clip(double now_s, double clip_s) {
    constexpr double kPause_s = 0.3;
    const bool goes_on = clip_s_ && clip_s != *clip_s_ && now_s - moved_s_ > kPause_s;
    if (source_ && (!clip_s_ || goes_on || has_jumped(*clip_s_, clip_s, 1 / coach_->trainer().fps)))
        source_->rewind(now_s, clip_s);
    if (clip_s_ != clip_s) moved_s_ = now_s;
    clip_s_ = clip_s;
}

// The end of a recorded motion is no news.
void Session::note_source() {
    const motion::PoseSourceState state = source_->state();
    if (state.stopped != was_stopped_ && !source_->is_recorded())
        notices_.push_back(
            fmt::format("{}: the trainee's motion {}", source_->name(), state.stopped ? "has stopped" : "goes on"));
    was_stopped_ = state.stopped;
    if (state.first_error.empty() || said_error_) return;
    said_error_ = true;
    notices_.push_back(state.first_error);
}

render::PerformerHighlight Session::highlight() const {
    if (!coach_ || !performer_) return {};
    return {*performer_, coach_->highlight()};
}

std::vector<GuideLine> Session::guide() const {
    if (!coach_ || !performer_) return {};
    std::vector<GuideLine> lines = guide_of(*coach_);
    const auto world = [this](const glm::dvec3& p) { return glm::dvec3(world_from_performer_ * glm::dvec4(p, 1)); };
    for (GuideLine& line : lines) line = {world(line.from), world(line.to), line.kind};
    return lines;
}

std::optional<Session::View> Session::best_view() const {
    if (!coach_ || !performer_ || !coach_->best_eye()) return std::nullopt;
    const auto world = [this](const glm::dvec3& p) { return glm::dvec3(world_from_performer_ * glm::dvec4(p, 1)); };
    return View{world(*coach_->best_eye()), world(coach_->centre())};
}

std::optional<double> Session::stage_time_of(const stage::Stage& stage, double clip_s, double stage_s) const {
    if (!performer_) return std::nullopt;
    const stage::StagePerformer& performer = stage.performers[*performer_];
    const double clip_fps = stage.clips[performer.clip].fps, frames = std::ceil(stage.duration_s * stage.fps);
    std::optional<double> nearest;
    for (double i = 0; i < frames; ++i) {
        const double at = i / stage.fps;
        if (std::abs(stage::frame_at(performer.timeline, at) / clip_fps - clip_s) > 0.75 / clip_fps) continue;
        if (!nearest || std::abs(at - stage_s) < std::abs(*nearest - stage_s)) nearest = at;
    }
    return nearest;
}

nlohmann::json Session::facts() const {
    nlohmann::json red;
    for (size_t i = 0; i < motion::kLimbs; ++i) red[motion::kLimbNames[i]] = coach_->red()[i];
    return {{"trainer", name_}, {"score", coach_->feedback().score}, {"red", red}, {"remarks", coach_->remarks()}};
}

std::vector<std::string> Session::take_notices() {
    return std::exchange(notices_, {});
}

}  // namespace neuvv::coach
