#include "tools/motion/motion_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "motion/video/best_view.h"
#include "tools/html.h"

namespace neuvv::tools {

namespace {

using motion::kJoints;
using motion::kLimbs;
using motion::Limb;

constexpr const char* kMotionStyle = R"(<style>
:root { color-scheme: light dark; --line: #8886; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5rem auto; padding: 0 1rem; max-width: 1200px; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .15rem .7rem; text-align: right; border-bottom: 1px solid var(--line); }
th:first-child, td:first-child { text-align: left; }
.score { font-size: 2.2rem; font-weight: 600; }
.plots, .moments { display: flex; flex-wrap: wrap; gap: 1rem; }
svg text { font: 11px system-ui, sans-serif; fill: currentColor; }
figure { margin: 0; border: 1px solid var(--line); padding: .4rem; } figcaption { max-width: 300px; }
</style>)";
constexpr const char* kWrong = "#e0342b";

std::string percent(double score) {
    return score < 0 ? "not measured" : fmt::format("{:.0f}", score);
}

std::string limb_table(const motion::Comparison& comparison, const motion::Tolerances& tolerances) {
    std::string rows;
    for (size_t limb = 0; limb < kLimbs; ++limb)
        rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.0f}°</td></tr>\n", motion::kLimbNames[limb],
                            percent(comparison.limb_scores[limb]), tolerances.tolerance[limb]);
    return "<table><thead><tr><th>limb</th><th>score</th><th>tolerance</th></tr></thead><tbody>" + rows +
           "</tbody></table>\n";
}

// A limb's error over the trainer's time, with its tolerance, and its mistakes shaded.
std::string error_curve(const motion::Comparison& comparison, Limb limb, double tolerance) {
    constexpr double kWidth = 560, kHeight = 150, kLeft = 40, kTop = 18, kRight = 10, kBottom = 22;
    const double duration = std::max(comparison.trainer_frame.back() / comparison.fps, 1 / comparison.fps);
    double high = 2 * tolerance;
    for (const motion::LimbErrors& errors : comparison.errors) high = std::max(high, errors[index_of(limb)]);
    const auto x = [&](double time_s) { return kLeft + time_s / duration * (kWidth - kLeft - kRight); };
    const auto y = [&](double error) { return kTop + (1 - error / high) * (kHeight - kTop - kBottom); };
    std::string marks, points;
    for (const motion::Mistake& mistake : comparison.mistakes)
        if (mistake.limb == limb)
            marks += fmt::format(R"(<rect x="{:.1f}" y="{}" width="{:.1f}" height="{}" fill="{}" opacity=".18"/>)",
                                 x(mistake.first_s), kTop, x(mistake.last_s) - x(mistake.first_s),
                                 kHeight - kTop - kBottom, kWrong);
    for (size_t i = 0; i < comparison.errors.size(); ++i)
        if (const double error = comparison.errors[i][index_of(limb)]; error >= 0)
            points += fmt::format("{:.1f},{:.1f} ", x(comparison.trainer_frame[i] / comparison.fps), y(error));
    return fmt::format(
        R"(<svg width="{0}" height="{1}" viewBox="0 0 {0} {1}" role="img"><title>{2}</title>{3})"
        R"(<path d="M{4},{5}V{6}H{7}" fill="none" stroke="currentColor" opacity=".5"/>)"
        R"(<path d="M{4},{8:.1f}H{7}" stroke="{9}" stroke-dasharray="4 3" opacity=".7"/>)"
        R"(<polyline points="{10}" fill="none" stroke="#2a7de1" stroke-width="1.6"/>)"
        R"(<text x="{11}" y="{12}" text-anchor="end">{13:.0f}°</text><text x="{11}" y="{6}" text-anchor="end">0°</text>)"
        R"(<text x="{4}" y="{14}">0 s</text><text x="{7}" y="{14}" text-anchor="end">{15:.1f} s</text>)"
        R"(<text x="{16}" y="12" text-anchor="middle">{2}</text></svg>)",
        kWidth, kHeight, motion::kLimbNames[index_of(limb)], marks, kLeft, kTop, kHeight - kBottom, kWidth - kRight,
        y(tolerance), kWrong, points, kLeft - 4, kTop + 8, high, kHeight - 6, duration, kWidth / 2);
}

// The frame of the trainee at which a mistake's limb is furthest off.
size_t worst_frame(const motion::Comparison& comparison, const motion::Mistake& mistake) {
    size_t worst = 0;
    double most = -1;
    for (size_t i = 0; i < comparison.errors.size(); ++i) {
        const double time_s = comparison.trainer_frame[i] / comparison.fps;
        if (time_s < mistake.first_s - 1e-9 || time_s > mistake.last_s + 1e-9) continue;
        const double error = comparison.errors[i][index_of(mistake.limb)];
        if (error > most) most = error, worst = i;
    }
    return worst;
}

// The trainee's pose in the trainer's place, direction and size.
motion::Pose in_place_of(const motion::Pose& trainee, const motion::Pose& trainer, double yaw, double scale) {
    const glm::dvec3 from = motion::at(trainee, motion::Joint::kPelvis).position;
    const glm::dvec3 to = motion::at(trainer, motion::Joint::kPelvis).position;
    const double c = std::cos(-yaw), s = std::sin(-yaw);
    motion::Pose pose = trainee;
    for (motion::JointSample& sample : pose) {
        const glm::dvec3 p = scale * (sample.position - from);
        sample.position = to + glm::dvec3(c * p.x + s * p.z, p.y, -s * p.x + c * p.z);
    }
    return pose;
}

// The directions of the world that are right and up in an image.
struct ImageAxes {
    glm::dvec3 right, up;
};

// The level direction from which the difference of both poses shows best. Of its two sides, the one before the trainer.
ImageAxes best_image(const motion::Pose& trainer, const motion::Pose& trainee) {
    std::vector<motion::WeightedError> errors;
    for (size_t j = 0; j < kJoints; ++j)
        if (trainer[j].measured && trainee[j].measured)
            errors.push_back({trainee[j].position - trainer[j].position, trainee[j].confidence});
    glm::dvec3 view = motion::best_level_view(errors);
    const glm::dvec3 left =
        motion::at(trainer, motion::Joint::kLeftHip).position - motion::at(trainer, motion::Joint::kRightHip).position;
    if (glm::dot(view, glm::cross(left, glm::dvec3(0, 1, 0))) < 0) view = -view;  // towards the camera
    return {glm::cross(glm::dvec3(0, 1, 0), view), {0, 1, 0}};
}

std::string stick_figure(const motion::Pose& pose, const ImageAxes& axes, const glm::dvec3& centre, double scale,
                         const char* colour, Limb wrong) {
    std::string lines;
    for (size_t j = 1; j < kJoints; ++j) {
        const motion::JointInfo& info = motion::info_of(motion::joint_at(j));
        const motion::JointSample& parent = motion::at(pose, info.parent);
        if (!(pose[j].confidence > 0 && parent.confidence > 0)) continue;
        const auto x = [&](const glm::dvec3& p) { return 150 + scale * glm::dot(p - centre, axes.right); };
        const auto y = [&](const glm::dvec3& p) { return 150 - scale * glm::dot(p - centre, axes.up); };
        lines += fmt::format(R"(<path d="M{:.1f},{:.1f}L{:.1f},{:.1f}" stroke="{}"/>)", x(parent.position),
                             y(parent.position), x(pose[j].position), y(pose[j].position),
                             info.limb == wrong ? kWrong : colour);
    }
    return lines;
}

std::string moment(const motion::SkeletonClip& trainer, const motion::SkeletonClip& trainee,
                   const motion::Comparison& comparison, const motion::Mistake& mistake) {
    const size_t frame = worst_frame(comparison, mistake);
    const double height = motion::body_height(motion::bone_lengths(trainer));
    const double trainee_height = motion::body_height(motion::bone_lengths(trainee));
    const motion::Pose shown = motion::pose_at(trainer, comparison.trainer_frame[frame]);
    const motion::Pose done =
        in_place_of(trainee.frames[frame], shown, comparison.yaw, trainee_height > 0 ? height / trainee_height : 1);
    const ImageAxes axes = best_image(shown, done);
    const glm::dvec3 centre = motion::at(shown, motion::Joint::kPelvis).position;
    const double scale = 130 / (height > 0 ? 0.62 * height : 1);
    constexpr Limb kNone = static_cast<Limb>(kLimbs);
    return R"(<figure><svg width="300" height="300" viewBox="0 0 300 300" fill="none" stroke-width="4" )"
           R"(stroke-linecap="round"><g opacity=".55">)" +
           stick_figure(shown, axes, centre, scale, "#8a8f98", kNone) + "</g>" +
           stick_figure(done, axes, centre, scale, "#2a7de1", mistake.limb) +
           fmt::format("</svg><figcaption>{} (at {:.2f} s)</figcaption></figure>\n", html_text(text_of(mistake)),
                       comparison.trainer_frame[frame] / comparison.fps);
}

}  // namespace

std::string motion_page(const MotionFacts& facts, const motion::SkeletonClip& trainer,
                        const motion::SkeletonClip& trainee, const motion::Comparison& comparison,
                        const motion::Tolerances& tolerances) {
    std::string page = kHtmlHead;
    const motion::SkeletonClip aligned = motion::resampled(trainee, trainer.fps);
    page += fmt::format("<title>{}</title>\n{}</head><body>\n", html_text(facts.trainee), kMotionStyle);
    page += fmt::format("<h1>{} against {}</h1>\n<p><span class=\"score\">{}</span> of 100</p>\n",
                        html_text(facts.trainee), html_text(facts.trainer), percent(comparison.score));
    page += limb_table(comparison, tolerances) + "<h2>Mistakes</h2>\n";
    if (comparison.mistakes.empty()) page += "<p>None.</p>\n";
    page += "<ul>\n";
    for (const motion::Mistake& mistake : comparison.mistakes)
        page += fmt::format("<li>{}</li>\n", html_text(text_of(mistake)));
    page += "</ul>\n<div class=\"moments\">\n";
    for (const motion::Mistake& mistake : comparison.mistakes) page += moment(trainer, aligned, comparison, mistake);
    page +=
        "</div>\n<p>Grey: the trainer. Blue: the trainee at its furthest, moved to the trainer's place, direction and "
        "size; red: the limb. Seen level, from where the difference shows best.</p>\n<h2>Errors</h2>\n"
        "<p>Angles between the bones of both, over the trainer's time. Dashed: the tolerance. Shaded: mistakes.</p>\n"
        "<div class=\"plots\">\n";
    for (size_t limb = 0; limb < kLimbs; ++limb)
        page += error_curve(comparison, static_cast<Limb>(limb), tolerances.tolerance[limb]);
    return page + "</div>\n</body></html>\n";
}

std::string motion_csv(const motion::Comparison& comparison) {
    std::string text = "time_s,trainer_time_s,score";
    for (const char* limb : motion::kLimbNames) text += fmt::format(",{}_deg", limb);
    std::ranges::replace(text, ' ', '_');
    text += '\n';
    for (size_t i = 0; i < comparison.errors.size(); ++i) {
        text += fmt::format("{:.4f},{:.4f},", static_cast<double>(i) / comparison.fps,
                            comparison.trainer_frame[i] / comparison.fps);
        if (comparison.scores[i] >= 0) text += fmt::format("{:.4f}", comparison.scores[i]);
        for (const double error : comparison.errors[i]) text += error >= 0 ? fmt::format(",{:.3f}", error) : ",";
        text += '\n';
    }
    return text;
}

}  // namespace neuvv::tools
