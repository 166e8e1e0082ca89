#include "tools/viewer/timeline/camera_path_view.h"

#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "edit/operations.h"
#include "editor/pointer.h"
#include "tools/ui/theme.h"
#include "tools/viewer/tools/overlay.h"

namespace neuvv::viewer {

namespace {

constexpr float kFrustum_px = 26;  // height of a frustum, at scale 1
constexpr unsigned kFlightColour = 0xc0e8a33d, kFrustumColour = 0xffd8d2cb;

// The frustum of a camera (whose image has height 2), of the same size in the image wherever the camera is.
void draw_frustum(const Context& context, const stage::Camera& camera, unsigned colour, float width) {
    const glm::dvec3 from(camera.world_from_camera[3]);
    if (editor::depth_of(context.frame.camera, from) < editor::kMinDepth_m) return;
    const double high = editor::metres_of_pixels(context.frame.camera, from, context.ui(kFrustum_px)) / 2;
    const double aspect =
        context.frame.camera.height > 0 ? 1.0 * context.frame.camera.width / context.frame.camera.height : 1;
    glm::dvec3 corners[4];
    for (int i = 0; i < 4; ++i) {
        const double x = i == 1 || i == 2 ? 1 : -1, y = i >= 2 ? 1 : -1;
        const glm::dvec4 corner(x * high * aspect, y * high, -high * camera.fy, 1);
        corners[i] = glm::dvec3(camera.world_from_camera * corner);
    }
    for (int i = 0; i < 4; ++i) {
        draw_line(context, from, corners[i], colour, width);
        draw_line(context, corners[i], corners[(i + 1) % 4], colour, width);
    }
}

}  // namespace

Eye eye_at(const stage::CameraPath& path, double time_s, const Context& context) {
    const glm::dmat4 world_from_camera = stage::camera_at(path, time_s, 2, 2).world_from_camera;
    if (!context.frame.stage) return eye_on(path, time_s, context.view.eye.distance);
    const auto [low, high] = stage::performers_box(*context.frame.stage, context.frame.evaluated);
    return eye_on(path, time_s, distance_to(world_from_camera, low, high));
}

void add_key_here(Context& context) {
    if (!context.editor.is_open()) return;
    const stage::CameraPathKey key = key_of(context.view.eye, context.view.clock.displayed_s());
    if (context.editor.edit([key, frame_s = 1 / context.view.clock.fps()](edit::Document& d) {
            return edit::add_path_key(d.file, key, frame_s);
        }))
        context.editor.notify(fmt::format("a key of the camera path at {:.2f} s", key.time_s));
}

void remove_nearest_key(Context& context) {
    if (!context.editor.is_open()) return;
    const std::optional<stage::CameraPath> path = edit::camera_path_of(context.editor.file());
    if (!path) return context.editor.notify("there is no camera path");
    const size_t key = nearest_key(*path, context.view.clock.displayed_s());
    context.editor.edit([key](edit::Document& d) { return edit::remove_path_key(d.file, key); });
}

void draw_camera_path(const Context& context, const stage::CameraPath& path, const std::vector<glm::dvec3>& line) {
    const Area& area = context.frame.image_area;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect({area.left, area.top}, {area.left + area.width, area.top + area.height});
    for (size_t i = 0; i + 1 < line.size(); ++i) draw_line(context, line[i], line[i + 1], kFlightColour, 2);
    for (const stage::CameraPathKey& key : path.keys)
        draw_frustum(context, stage::camera_at(path, key.time_s, 2, 2), kFrustumColour, 1);
    draw_frustum(context, stage::camera_at(path, context.view.clock.displayed_s(), 2, 2), ui::kAccent, 2);
    list.PopClipRect();
}

}  // namespace neuvv::viewer
