#include "tools/headset/state/coaching.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "media/colour.h"

namespace neuvv::headset {

namespace {

constexpr double kGuideWidth_m = 0.012;
constexpr double kVertical = 1e-3;  // sine of the least angle to the axis that has a heading

// The angle about +Y from +Z to the direction; nothing for one along the axis.
std::optional<double> heading_of(const glm::dvec3& direction) {
    if (!(std::hypot(direction.x, direction.z) > kVertical * glm::length(direction))) return std::nullopt;
    return std::atan2(direction.x, direction.z);
}

glm::dmat4 turned_about(const glm::dvec3& centre, double angle_rad) {
    return glm::translate(glm::dmat4(1), centre) * glm::rotate(glm::dmat4(1), angle_rad, glm::dvec3(0, 1, 0)) *
           glm::translate(glm::dmat4(1), -centre);
}

}  // namespace

void TrainerTurn::show(const glm::dvec3& centre, const glm::dvec3& eye, const glm::dvec3& head) {
    const std::optional<double> from = heading_of(eye - centre), to = heading_of(head - centre);
    if (!from || !to) return;
    from_ = performer_from_turned();
    centre_ = centre;
    by_rad_ = std::remainder(*to - *from, 2 * glm::pi<double>());
    passed_s_ = 0;
}

glm::dmat4 TrainerTurn::performer_from_turned() const {
    const double share = std::clamp(passed_s_ / kTurn_s, 0.0, 1.0);
    return from_ * turned_about(centre_, by_rad_ * share * share * (3 - 2 * share));
}

double TrainerTurn::angle_rad() const {
    const glm::dvec4 ahead = performer_from_turned()[2];
    return std::atan2(ahead.x, ahead.z);
}

void Coaching::begin(HeadsetState& state) {
    const std::optional<uint32_t> selected = state.selected_performer();
    const std::string name = selected ? state.stage->performers[*selected].name : "";
    jobs_.start("Reading the trainer's skeleton", [this, &state, stage = state.stage, name]() -> JobQueue::Then {
        const auto trainer = std::make_shared<coach::Trainer>(coach::read_trainer(*stage, name));
        return [this, &state, trainer] {
            if (!is_running()) begin(state, std::move(*trainer), std::move(source_));
        };
    });
}

void Coaching::begin(HeadsetState& state, coach::Trainer trainer, std::unique_ptr<motion::PoseSource> source) {
    if (!is_running()) own_speed_ = state.clock.speed;
    session_.begin(std::move(trainer), std::move(source), settings);
    settings.mode = session_.coach().settings().mode;
    turn_ = {};
    state.tool = HandTool::kCoach;
    if (settings.mode == coach::Mode::kPerform) state.clock.scrub(state.clock.in_s());
    if (!state.clock.playing) state.clock.play_or_pause();
}

void Coaching::end(HeadsetState& state) {
    if (!is_running()) return;
    source_ = session_.end();
    state.trainer.reset();
    turn_ = {};
    state.clock.speed = own_speed_;
}

void Coaching::turn_trainer(HeadsetState& state, double dt_s) {
    now_s_ += dt_s;
    state.trainer.reset();
    if (!is_running()) return;
    turn_.advance(dt_s);
    const auto& performers = state.stage->performers;
    const auto found = std::ranges::find(performers, session_.trainer_name(), &stage::StagePerformer::name);
    if (found == performers.end()) return;
    state.trainer = static_cast<uint32_t>(std::distance(performers.begin(), found));
    state.evaluated.performers[*state.trainer].world_from_performer *= turn_.performer_from_turned();
}

void Coaching::update(HeadsetState& state, const std::optional<motion::Pose>& body, const glm::dvec3& head) {
    if (!is_running()) return;
    head_ = head;
    if (settings.mode == coach::Mode::kPerform && session_.coach().settings().mode != settings.mode) {
        session_.coach().change(settings);
        return state.clock.scrub(state.clock.in_s());  // a performance begins at the beginning
    }
    session_.coach().change(settings);
    std::optional<motion::TimedPose> pose;
    if (body) pose = motion::TimedPose{now_s_, *body};
    session_.update(*state.stage, state.evaluated, now_s_, pose);
    if (state.clock.playing) state.clock.speed = session_.coach().clip_speed();
    for (std::string& notice : session_.take_notices()) state.editor.notify(std::move(notice));
}

void Coaching::repeat_mistake(HeadsetState& state) {
    if (!is_running() || !session_.coach().last_mistake_s()) return;
    const auto at = session_.stage_time_of(*state.stage, *session_.coach().last_mistake_s(), state.clock.time_s());
    if (!at) return;
    state.clock.scrub(*at);
    if (!state.clock.playing) state.clock.play_or_pause();
}

void Coaching::show_best_view() {
    const std::optional<coach::Session::View> view = session_.best_view();
    if (!view) return;
    const glm::dmat4 turned_from_world = glm::inverse(session_.world_from_performer());
    const auto turned = [&](const glm::dvec3& world) { return glm::dvec3(turned_from_world * glm::dvec4(world, 1)); };
    turn_.show(turned(view->target), turned(view->eye), turned(head_));
}

nlohmann::json Coaching::facts() const {
    if (!is_running()) return nullptr;
    nlohmann::json facts = session_.facts();
    facts["ghost"] = session_.coach().ghost().has_value();
    facts["mode"] = coach::kModeNames[static_cast<size_t>(settings.mode)];
    facts["trainer_turned_deg"] = glm::degrees(turn_.angle_rad());
    return facts;
}

void draw_guide(xr::EyeShapes& shapes, const std::vector<coach::GuideLine>& lines) {
    shapes.draw_on_top(true);
    for (const coach::GuideLine& line : lines) {
        const glm::vec4 colour(media::linear_from_srgb(coach::kGuideColours[static_cast<size_t>(line.kind)]), 1);
        shapes.line(line.from, line.to, kGuideWidth_m, colour, colour);
    }
    shapes.draw_on_top(false);
}

}  // namespace neuvv::headset
