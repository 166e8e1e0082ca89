#include "tools/viewer/eye_motion.h"

#include <utility>

#include "tools/viewer/timeline/camera_path_view.h"
#include "tools/viewer/tools/overlay.h"

namespace neuvv::viewer {

namespace {

constexpr double kFirstPitch = -0.12;

}  // namespace

void EyeMotion::move(Context& context) {
    ViewState& view = context.view;
    const FrameInput& frame = context.frame;
    if (context.requests.eye)
        flight_ = Flight{view.eye, *std::exchange(context.requests.eye, std::nullopt), frame.now_s};
    if (flight_) {
        const double flown_s = frame.now_s - flight_->begin_s;
        view.eye = between(flight_->from, flight_->to, flown_s);
        if (flown_s > kEyeMove_s) flight_.reset();
        context.mark_motion();
    }
    const bool moved = path_eye_ && view.eye != *path_eye_;
    if (!frame.stage || !frame.stage->settings.camera_path || moved) view.along_path = false;
    path_eye_.reset();
    if (!view.along_path) return;
    path_eye_ = eye_at(*frame.stage->settings.camera_path, view.clock.displayed_s(), context);
    view.eye = *path_eye_;
}

Eye initial_eye(const Context& context, const stage::EvaluatedStage& evaluated) {
    const stage::Stage& stage = *context.frame.stage;
    for (const stage::EvaluatedCamera& camera : evaluated.cameras)
        if (!camera.orthographic) return eye_of(camera, stage, evaluated);
    auto [low, high] = stage::performers_box(stage, evaluated);
    if (const auto leaves = box_of_performers(context, evaluated)) std::tie(low, high) = *leaves;
    Eye eye = seen_from(Eye{}, EyeSide::kFront);
    eye.pitch = kFirstPitch;
    const Area& area = context.frame.image_area;
    return framed(eye, low, high, area.height > 0 ? area.width / area.height : 1);
}

}  // namespace neuvv::viewer
