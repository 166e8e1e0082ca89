// What is drawn over the image: a floor of lines, signs of lights and cameras, the box of what is selected, handles.
#include <imgui.h>

#include <cmath>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/tools/image_tools.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

namespace {

constexpr unsigned kGridColour = 0x30ffffff, kAxisX = 0x705050e0, kAxisZ = 0x70e08050;
constexpr int kGridReach_m = 10;
constexpr glm::vec4 kHotHandle(1, 0.95f, 0.4f, 1);

class Drawing {
  public:
    explicit Drawing(const Viewer& viewer)
        : viewer_(viewer),
          list_(*ImGui::GetBackgroundDrawList()),
          left_(viewer.image_area.left),
          top_(viewer.image_area.top) {
        const Area& area = viewer.image_area;
        list_.PushClipRect({left_, top_}, {left_ + area.width, top_ + area.height});
    }
    ~Drawing() { list_.PopClipRect(); }
    Drawing(const Drawing&) = delete;
    Drawing& operator=(const Drawing&) = delete;

    ImVec2 at(glm::dvec2 pixel) const {
        return {left_ + static_cast<float>(pixel.x), top_ + static_cast<float>(pixel.y)};
    }
    void line(glm::dvec3 a, glm::dvec3 b, unsigned colour, float width = 1) {
        if (const auto pixels = editor::pixels_of(viewer_.camera, a, b))
            list_.AddLine(at(pixels->first), at(pixels->second), colour, viewer_.ui(width));
    }
    void sign(glm::dvec3 place, const char* sign, unsigned colour) {
        const auto pixel = editor::pixel_of(viewer_.camera, place);
        if (!pixel) return;
        const ImVec2 size = ImGui::CalcTextSize(sign), middle = at(*pixel);
        list_.AddCircleFilled(middle, 0.75f * size.y, 0x90000000);
        list_.AddText({middle.x - size.x / 2, middle.y - size.y / 2}, colour, sign);
    }
    void box(glm::dvec3 low, glm::dvec3 high, unsigned colour) {
        for (int axis = 0; axis < 3; axis++)
            for (int corner = 0; corner < 4; corner++) {
                glm::dvec3 a = low, b;
                a[(axis + 1) % 3] = corner & 1 ? high[(axis + 1) % 3] : low[(axis + 1) % 3];
                a[(axis + 2) % 3] = corner & 2 ? high[(axis + 2) % 3] : low[(axis + 2) % 3];
                b = a;
                b[axis] = high[axis];
                line(a, b, colour);
            }
    }
    void shape(const HandleShape& shape) {
        std::vector<ImVec2> points;
        for (uint32_t i = 0; i < shape.count; i++) points.push_back(at(glm::dvec2(shape.points[i])));
        const glm::vec4 c = shape.colour;
        const ImU32 colour = ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, c.a});
        if (shape.filled)
            list_.AddConvexPolyFilled(points.data(), static_cast<int>(points.size()), colour);
        else
            list_.AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, viewer_.ui(2));
    }

  private:
    const Viewer& viewer_;
    ImDrawList& list_;
    float left_, top_;
};

void draw_grid(Drawing& drawing) {
    for (int i = -kGridReach_m; i <= kGridReach_m; i++) {
        drawing.line({i, 0, -kGridReach_m}, {i, 0, kGridReach_m}, i == 0 ? kAxisZ : kGridColour);
        drawing.line({-kGridReach_m, 0, i}, {kGridReach_m, 0, i}, i == 0 ? kAxisX : kGridColour);
    }
}

unsigned colour_of(const Viewer& viewer, uint32_t node) {
    return viewer.editor.selected() == node ? ui::kAccent : 0xffd8d4d0;
}

}  // namespace

std::pair<glm::dvec3, glm::dvec3> box_of_node(const Viewer& viewer, uint32_t node) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    const auto take = [&](glm::dvec3 place) {
        low = glm::min(low, place);
        high = glm::max(high, place);
    };
    const auto take_box = [&](const glm::dmat4& world, glm::dvec3 from, glm::dvec3 to) {
        for (int i = 0; i < 8; i++)
            take(world * glm::dvec4(i & 1 ? to.x : from.x, i & 2 ? to.y : from.y, i & 4 ? to.z : from.z, 1));
    };
    const auto hangs_on = [&](uint32_t one) {
        for (int64_t i = one; i >= 0; i = viewer.stage->scene.nodes[static_cast<size_t>(i)].parent)
            if (i == node) return true;
        return false;
    };
    for (const stage::EvaluatedPerformer& performer : viewer.evaluated.performers) {
        if (!hangs_on(viewer.stage->performers[performer.performer].node)) continue;
        const auto& [from, to] = viewer.drawn.leaf_boxes[performer.clip];
        take_box(performer.world_from_performer, from, to);
    }
    const stage::GltfScene& scene = viewer.stage->scene;
    for (uint32_t i = 0; i < scene.nodes.size(); i++) {
        if (scene.nodes[i].mesh < 0 || !hangs_on(i)) continue;
        for (const stage::GltfPrimitive& primitive : scene.meshes[static_cast<size_t>(scene.nodes[i].mesh)].primitives)
            for (const glm::vec3& position : primitive.positions)
                take(viewer.evaluated.pose.world_from_node[i] * glm::dvec4(position, 1));
    }
    if (low.x > high.x) take(glm::dvec3(viewer.evaluated.pose.world_from_node[node][3]));
    return {low, high};
}

void draw_overlay(Viewer& viewer) {
    if (!viewer.stage) return;
    Drawing drawing(viewer);
    if (viewer.grid) draw_grid(drawing);
    if (viewer.panels.all) {
        for (const stage::EvaluatedLight& light : viewer.evaluated.lights)
            drawing.sign(light.position, ICON_LIGHT, colour_of(viewer, light.node));
        for (const stage::EvaluatedCamera& camera : viewer.evaluated.cameras)
            drawing.sign(glm::dvec3(camera.world_from_camera[3]), ICON_CAMERA, colour_of(viewer, camera.node));
    }
    if (viewer.editor.selected() && viewer.stage_of_document()) {
        const auto [low, high] = box_of_node(viewer, *viewer.editor.selected());
        drawing.box(low, high, ui::kAccentDim);
    }
    for (const HandleShape& shape : viewer.shapes) drawing.shape(shape);
    viewer.shapes.clear();
}

void show_handles(Viewer& viewer, std::span<const HandleShape> shapes, int hot) {
    for (HandleShape shape : shapes) {
        if (hot != 0 && shape.handle == hot) shape.colour = kHotHandle;
        viewer.shapes.push_back(shape);
    }
}

bool keeps_hold(Viewer& viewer) {
    if (viewer.escape) viewer.editor.cancel_drag();
    return !viewer.escape && ImGui::IsMouseDown(ImGuiMouseButton_Left);
}

glm::dmat4 world_from_parent(const Viewer& viewer, uint32_t node) {
    const int32_t parent = viewer.stage->scene.nodes[node].parent;
    return parent < 0 ? glm::dmat4(1) : viewer.evaluated.pose.world_from_node[static_cast<size_t>(parent)];
}

glm::dvec2 pointer_of(const Viewer& viewer) {
    const ImVec2 at = ImGui::GetIO().MousePos;
    return {at.x - viewer.image_area.left, at.y - viewer.image_area.top};
}

std::optional<uint32_t> sign_at(const Viewer& viewer, float x, float y) {
    if (!viewer.panels.all || !viewer.stage_of_document()) return std::nullopt;
    std::optional<uint32_t> found;
    const auto look = [&](glm::dvec3 place, uint32_t node) {
        const auto pixel = editor::pixel_of(viewer.camera, place);
        if (!pixel) return;
        const glm::dvec2 at = *pixel + glm::dvec2(viewer.image_area.left, viewer.image_area.top);
        if (glm::distance(at, glm::dvec2(x, y)) < viewer.ui(12)) found = node;
    };
    for (const stage::EvaluatedLight& light : viewer.evaluated.lights) look(light.position, light.node);
    for (const stage::EvaluatedCamera& camera : viewer.evaluated.cameras)
        look(glm::dvec3(camera.world_from_camera[3]), camera.node);
    return found;
}

}  // namespace neuvv::viewer
