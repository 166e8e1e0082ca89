#include "tools/viewer/coaching.h"

#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/output_path.h"
#include "motion/compare/compare.h"
#include "tools/motion/motion_page.h"
#include "tools/viewer/tools/overlay.h"

namespace neuvv::viewer {

namespace {

std::string selected_performer_name(const Context& context) {
    const stage::Stage* stage = context.stage_of_document();
    if (!stage || !context.editor.selected()) return "";
    for (const stage::StagePerformer& performer : stage->performers)
        if (performer.node == *context.editor.selected()) return performer.name;
    return "";
}

// The eye looks at the target from a point of the world; the angle of view stays.
Eye looking_at(const Eye& eye, const coach::Session::View& view) {
    const glm::dvec3 back = view.eye - view.target;
    Eye result = eye;
    result.pivot = view.target;
    result.distance = glm::length(back);
    result.yaw = std::atan2(back.x, back.z);
    result.pitch = -std::asin(std::clamp(back.y / result.distance, -1.0, 1.0));
    result.roll = 0;
    return result;
}

}  // namespace

void Coaching::begin(Context& context) {
    if (begins_ || !context.frame.stage) return;
    begins_ = true;
    const std::string name = selected_performer_name(context);
    const auto read = [stage = context.frame.stage, name, from = address] {
        auto source = motion::open_pose_source(from);
        return std::pair(coach::read_trainer(*stage, name), std::move(source));
    };
    context.jobs.start("Reading the trainer's skeleton",
                       [this, &context, read, opened = context.editor.open_count()]() -> JobQueue::Then {
                           using Read = std::pair<coach::Trainer, std::unique_ptr<motion::PoseSource>>;
                           std::shared_ptr<Read> found;
                           std::string problem;
                           try {
                               found = std::make_shared<Read>(read());
                           } catch (const std::exception& error) {
                               problem = error.what();
                           }
                           return [this, &context, found, problem, opened] {
                               begins_ = false;
                               if (opened != context.editor.open_count())
                                   return;  // another document has been opened meanwhile
                               if (!found) return context.editor.notify(problem, true);
                               if (!is_running()) own_speed_ = context.view.clock.speed;
                               session_.begin(std::move(found->first), std::move(found->second), settings);
                               settings.mode = session_.coach().settings().mode;
                               opened_ = opened;
                               if (settings.mode == coach::Mode::kPerform)
                                   context.view.clock.scrub(context.view.clock.in_s());
                               if (!context.view.clock.playing) context.view.clock.play_or_pause();
                           };
                       });
}

void Coaching::end(Context& context) {
    if (!is_running()) return;
    session_.end();
    context.view.clock.speed = own_speed_;
    context.redraw();
}

void Coaching::tick(Context& context) {
    if (awaits_stage_ && context.frame.stage) {
        awaits_stage_ = false;
        begin(context);
    }
    if (!is_running() || !context.frame.stage) return;
    if (opened_ != context.editor.open_count()) return end(context);  // another document
    if (settings.mode == coach::Mode::kPerform && session_.coach().settings().mode != settings.mode) {
        session_.coach().change(settings);
        return context.view.clock.scrub(context.view.clock.in_s());  // a performance begins at the beginning
    }
    session_.coach().change(settings);
    session_.update(*context.frame.stage, context.frame.evaluated, context.frame.now_s);
    context.view.clock.speed = session_.coach().clip_speed();
    for (const std::string& notice : session_.take_notices()) context.editor.notify(notice);
    if (const render::PerformerHighlight now = session_.highlight(); now != shown_) {
        shown_ = now;
        context.mark_motion();
    }
}

void Coaching::draw(const Context& context) const {
    const Area& area = context.frame.image_area;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect({area.left, area.top}, {area.left + area.width, area.top + area.height});
    for (const coach::GuideLine& line : session_.guide()) {
        const glm::vec3 colour = coach::kGuideColours[static_cast<size_t>(line.kind)];
        draw_line(context, line.from, line.to, ImGui::ColorConvertFloat4ToU32({colour.r, colour.g, colour.b, 1}), 2);
    }
    list.PopClipRect();
}

void Coaching::repeat_mistake(Context& context) {
    if (!is_running() || !session_.coach().last_mistake_s()) return;
    editor::StageClock& clock = context.view.clock;
    const auto at = session_.stage_time_of(*context.frame.stage, *session_.coach().last_mistake_s(), clock.time_s());
    if (!at) return;
    clock.scrub(*at);
    if (!clock.playing) clock.play_or_pause();
}

void Coaching::show_best_view(Context& context) const {
    if (const auto view = session_.best_view()) context.go_to(looking_at(context.view.eye, *view));
}

void Coaching::write_report(Context& context) const {
    if (!is_running() || session_.coach().recorded().frames.empty()) return;
    const coach::Coach& coach = session_.coach();
    std::filesystem::path page = context.editor.file().path;
    page.replace_filename(page.stem().string() + "-report.html");
    const tools::MotionFacts facts{session_.trainer_name(), session_.source() ? session_.source()->name() : ""};
    context.jobs.start("Writing " + page.filename().string(), [page, facts, trainer = coach.shown_to_recorded(),
                                                               trainee = coach.recorded(),
                                                               options = coach.settings().compare, &context] {
        const motion::Comparison found = motion::compare(trainer, trainee, options);
        write_text_file(page, tools::motion_page(facts, trainer, trainee, found, options.tolerances));
        return [page, &context] { context.editor.notify("wrote " + page.string()); };
    });
}

nlohmann::json Coaching::facts() const {
    if (!is_running()) return nullptr;
    nlohmann::json facts = session_.facts();
    facts["speed"] = session_.coach().clip_speed();
    facts["recorded"] = session_.coach().recorded().frames.size();
    facts["poses"] = session_.source() ? session_.source()->state().poses : 0;
    return facts;
}

}  // namespace neuvv::viewer
