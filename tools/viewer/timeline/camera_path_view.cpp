#include "tools/viewer/timeline/camera_path_view.h"

#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "edit/operations.h"
#include "editor/pointer.h"
#include "tools/ui/theme.h"

namespace neuvv::viewer {

namespace {

constexpr float kSightPixels = 26;  // of a pyramid of sight, at scale 1
constexpr unsigned kWay = 0xc0e8a33d, kKeyColour = 0xffd8d2cb;

void draw_line(const Viewer& viewer, glm::dvec3 a, glm::dvec3 b, unsigned colour, float width) {
    const auto seen = editor::pixels_of(viewer.camera, a, b);
    if (!seen) return;
    const auto at = [&](glm::dvec2 pixel) {
        return ImVec2(viewer.image_area.left + static_cast<float>(pixel.x),
                      viewer.image_area.top + static_cast<float>(pixel.y));
    };
    ImGui::GetBackgroundDrawList()->AddLine(at(seen->first), at(seen->second), colour, viewer.ui(width));
}

// From the camera's place to the corners of what it sees, as large in the image wherever it stands.
void draw_sight(const Viewer& viewer, const stage::Camera& seen, unsigned colour, float width) {
    const glm::dvec3 from(seen.world_from_camera[3]);
    if (editor::depth_of(viewer.camera, from) < editor::kNearest_m) return;
    const double high = editor::metres_of_pixels(viewer.camera, from, viewer.ui(kSightPixels)) / 2;
    const double aspect = viewer.camera.height > 0 ? 1.0 * viewer.camera.width / viewer.camera.height : 1;
    glm::dvec3 corners[4];
    for (int i = 0; i < 4; i++) {
        const double x = i == 1 || i == 2 ? 1 : -1, y = i >= 2 ? 1 : -1;
        const glm::dvec4 corner(x * high * aspect, y * high, -high * seen.fy, 1);  // fy for a height of 2
        corners[i] = glm::dvec3(seen.world_from_camera * corner);
    }
    for (int i = 0; i < 4; i++) {
        draw_line(viewer, from, corners[i], colour, width);
        draw_line(viewer, corners[i], corners[(i + 1) % 4], colour, width);
    }
}

}  // namespace

Eye eye_at(const stage::CameraPath& path, double time_s, const Viewer& viewer) {
    const glm::dmat4 world_from_camera = stage::camera_at(path, time_s, 2, 2).world_from_camera;
    if (!viewer.stage) return eye_on(path, time_s, viewer.eye.distance);
    const auto [low, high] = stage::performers_box(*viewer.stage, viewer.evaluated);
    return eye_on(path, time_s, distance_to(world_from_camera, low, high));
}

void add_key_here(Viewer& viewer) {
    if (!viewer.editor.is_open()) return;
    const stage::CameraPathKey key = key_of(viewer.eye, viewer.clock.shown_s());
    if (viewer.editor.edit([key, frame_s = 1 / viewer.clock.fps()](edit::Document& d) {
            return edit::add_path_key(d.file, key, frame_s);
        }))
        viewer.editor.notify(fmt::format("a key of the camera path at {:.2f} s", key.time_s));
}

void remove_key_near(Viewer& viewer) {
    if (!viewer.editor.is_open()) return;
    const std::optional<stage::CameraPath> path = edit::camera_path_of(viewer.editor.file());
    if (!path) return viewer.editor.notify("there is no camera path");
    const size_t key = nearest_key(*path, viewer.clock.shown_s());
    viewer.editor.edit([key](edit::Document& d) { return edit::remove_path_key(d.file, key); });
}

void draw_camera_path(const Viewer& viewer, const stage::CameraPath& path, const std::vector<glm::dvec3>& line) {
    const Area& area = viewer.image_area;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect({area.left, area.top}, {area.left + area.width, area.top + area.height});
    for (size_t i = 0; i + 1 < line.size(); i++) draw_line(viewer, line[i], line[i + 1], kWay, 2);
    for (const stage::CameraPathKey& key : path.keys)
        draw_sight(viewer, stage::camera_at(path, key.time_s, 2, 2), kKeyColour, 1);
    draw_sight(viewer, stage::camera_at(path, viewer.clock.shown_s(), 2, 2), ui::kAccent, 2);
    list.PopClipRect();
}

}  // namespace neuvv::viewer
