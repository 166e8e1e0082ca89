#include "coach/coach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::coach {

namespace {

constexpr double kGone_s = 1;         // without a pose, after which the trainee counts as gone
constexpr double kSlowest = 0.2;      // of the clip's speed, while it waits for the trainee
constexpr double kLateFree_s = 0.15;  // by which a trainee may be late before the clip slows down
constexpr double kLateWhole_s = 0.6;  // by which it is as slow as it gets
constexpr double kWhole = 0.9;        // of the clip: a performance of as much counts as whole
constexpr double kGap_s = 0.25;       // of the clip between two images, that the record bridges
constexpr double kRunUp_s = 1;        // before a mistake that is repeated

std::string text_of(motion::Limb limb, const motion::LimbFeedback& feedback) {
    const char* name = motion::kLimbNames[motion::index_of(limb)];
    if (feedback.late_s > 0) return fmt::format("{}: {:.1f} s late", name, feedback.late_s);
    if (feedback.late_s < 0) return fmt::format("{}: {:.1f} s early", name, -feedback.late_s);
    return fmt::format("{}: {:.0f}° off", name, feedback.error_deg);
}

}  // namespace

Coach::Coach(motion::SkeletonClip trainer, CoachSettings settings)
    : trainer_(std::move(trainer)),
      height_(motion::body_height(motion::bone_lengths(trainer_))),
      settings_(std::move(settings)),
      live_(std::make_unique<motion::LiveComparison>(trainer_, settings_.compare)) {
    assert(!trainer_.frames.empty());
    if (!(height_ > 0)) height_ = 1.7;  // a skeleton without legs
}

void Coach::change(const CoachSettings& settings) {
    const bool same = settings.compare.counted == settings_.compare.counted &&
                      settings.compare.tolerances.tolerance == settings_.compare.tolerances.tolerance &&
                      settings.mirrored == settings_.mirrored;
    settings_ = settings;
    if (same) return;
    live_ = std::make_unique<motion::LiveComparison>(trainer_, settings_.compare);
    recorded_.frames.clear();
    performed_.frames.clear();
    performed_frames_ = 0;
    was_wrong_ = {};
}

// Whether somebody is there to be compared.
bool Coach::compares() const {
    return settings_.mode != Mode::kWatch && trainee_ && now_s_ - trainee_->time_s < kGone_s;
}

void Coach::update(const std::optional<motion::TimedPose>& pose, double now_s, double clip_s) {
    const double step_s = std::max(0.0, now_s - now_s_);
    now_s_ = now_s;
    if (clip_s_ >= 0 && has_jumped(clip_s_, clip_s, 1 / trainer_.fps)) {
        live_->jump();
        if (clip_s < clip_s_) begin_record();
    } else {
        clip_s = std::max(clip_s, clip_s_);
    }
    clip_s_ = clip_s;
    if (pose) {
        trainee_ = pose;
        if (settings_.mirrored) trainee_->pose = motion::mirrored(pose->pose);
    }
    if (!compares()) return;
    if (pose) live_->add(trainee_->pose, pose->time_s, clip_s);
    note_mistakes(clip_s);
    record(clip_s);
    choose_view(step_s);
}

// A limb that was already wrong is no new mistake.
void Coach::note_mistakes(double clip_s) {
    for (size_t i = 0; i < motion::kLimbs; ++i) {
        const bool wrong = feedback().limbs[i].wrong;
        if (wrong && !was_wrong_[i]) last_mistake_s_ = clip_s;
        was_wrong_[i] = wrong;
    }
}

// Keeps the record where it reached the clip's end.
void Coach::begin_record() {
    if (static_cast<double>(performed_frames_) > kWhole * static_cast<double>(trainer_.frames.size()))
        std::swap(performed_, recorded_);
    recorded_.frames.clear();
    performed_frames_ = 0;
}

motion::SkeletonClip Coach::shown_to_recorded() const {
    motion::SkeletonClip shown = trainer_;
    shown.frames.resize(std::clamp<size_t>(recorded().frames.size(), 1, trainer_.frames.size()));
    return shown;
}

// A frame of the record for each frame that the clip has advanced.
void Coach::record(double clip_s) {
    if (settings_.mode != Mode::kPerform) return;
    recorded_.fps = trainer_.fps;
    const auto frames =
        static_cast<size_t>(std::clamp(clip_s * trainer_.fps + 1, 0.0, double{motion::kMaxSkeletonFrames}));
    // A gap is nobody's performance: the clip has jumped, or the trainee was away.
    const auto gap = static_cast<size_t>(kGap_s * trainer_.fps) + 1;
    if (frames > recorded_.frames.size() + gap) recorded_.frames.resize(frames - 1);
    for (; recorded_.frames.size() < frames; ++performed_frames_) recorded_.frames.push_back(trainee_->pose);
}

void Coach::choose_view(double step_s) {
    const std::vector<JointError> wrong = errors();
    best_eye_ = chooser_.choose(wrong, wrong.empty() ? std::vector<BodyBone>{} : body(), centre(),
                                kViewDistance * height_, step_s);
}

double Coach::clip_speed() const {
    if (settings_.mode != Mode::kFollow || !compares()) return settings_.speed;
    const double late_s = clip_s_ - feedback().trainer_time_s;
    const double by_lag = std::clamp((late_s - kLateFree_s) / (kLateWhole_s - kLateFree_s), 0.0, 1.0);
    return settings_.speed * glm::mix(1.0, kSlowest, std::max(by_lag, std::ranges::max(red())));
}

motion::Pose Coach::shown() const {
    return motion::pose_at(trainer_, clip_s_ * trainer_.fps);
}

glm::dvec3 Coach::centre() const {
    return shown()[motion::index_of(motion::Joint::kPelvis)].position;
}

std::vector<BodyBone> Coach::body() const {
    return body_of(shown(), height_);
}

LimbValues Coach::red() const {
    LimbValues red{};
    if (!compares()) return red;
    for (size_t i = 0; i < motion::kLimbs; ++i) red[i] = feedback().limbs[i].red;
    return red;
}

std::shared_ptr<const render::Highlight> Coach::highlight() const {
    if (std::ranges::max(red()) == 0) return nullptr;
    return std::make_shared<const render::Highlight>(highlight_of(body(), red()));
}

std::optional<motion::Pose> Coach::ghost() const {
    if (!compares()) return std::nullopt;
    return ghost_of(trainee_->pose, shown(), feedback().yaw);
}

std::vector<JointError> Coach::errors() const {
    const std::optional<motion::Pose> there = ghost();
    if (!there) return {};
    return joint_errors(*there, shown(), red());
}

std::vector<std::string> Coach::remarks() const {
    std::vector<std::string> lines;
    if (!compares()) return lines;
    for (size_t i = 0; i < motion::kLimbs; ++i)
        if (feedback().limbs[i].wrong) lines.push_back(text_of(static_cast<motion::Limb>(i), feedback().limbs[i]));
    return lines;
}

std::optional<double> Coach::last_mistake_s() const {
    if (!last_mistake_s_) return std::nullopt;
    return std::max(0.0, *last_mistake_s_ - kRunUp_s);
}

}  // namespace neuvv::coach
