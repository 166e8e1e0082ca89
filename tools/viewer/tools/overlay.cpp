#include "tools/viewer/tools/overlay.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "edit/operations.h"
#include "editor/pointer.h"
#include "tools/ui/icons.h"
#include "tools/ui/theme.h"

namespace neuvv::viewer {

namespace {

constexpr unsigned kGridColour = 0x30ffffff, kAxisX = 0x705050e0, kAxisZ = 0x70e08050;
constexpr int kGridSize_m = 10;  // from the centre to an edge
constexpr glm::vec4 kHotHandle(1, 0.95f, 0.4f, 1);

// Draws over the image, clipped to its area.
class Drawing {
  public:
    explicit Drawing(const Context& context) : context_(context), list_(*ImGui::GetBackgroundDrawList()) {
        const Area& area = context.frame.image_area;
        list_.PushClipRect({area.left, area.top}, {area.left + area.width, area.top + area.height});
    }
    ~Drawing() { list_.PopClipRect(); }
    Drawing(const Drawing&) = delete;
    Drawing& operator=(const Drawing&) = delete;

    void line(glm::dvec3 a, glm::dvec3 b, unsigned colour) { draw_line(context_, a, b, colour, 1); }
    void icon(glm::dvec3 position, const char* text, unsigned colour) {
        const auto pixel = editor::pixel_of(context_.frame.camera, position);
        if (!pixel) return;
        const ImVec2 size = ImGui::CalcTextSize(text), centre = in_window(context_, *pixel);
        list_.AddCircleFilled(centre, 0.75f * size.y, 0x90000000);
        list_.AddText({centre.x - size.x / 2, centre.y - size.y / 2}, colour, text);
    }
    void box(glm::dvec3 low, glm::dvec3 high, unsigned colour) {
        for (int axis = 0; axis < 3; ++axis)
            for (int corner = 0; corner < 4; ++corner) {
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
        for (uint32_t i = 0; i < shape.count; ++i) points.push_back(in_window(context_, glm::dvec2(shape.points[i])));
        const glm::vec4 c = shape.colour;
        const ImU32 colour = ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, c.a});
        if (shape.filled)
            list_.AddConvexPolyFilled(points.data(), static_cast<int>(points.size()), colour);
        else
            list_.AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, context_.ui(2));
    }

  private:
    const Context& context_;
    ImDrawList& list_;
};

void draw_grid(Drawing& drawing) {
    for (int i = -kGridSize_m; i <= kGridSize_m; ++i) {
        drawing.line({i, 0, -kGridSize_m}, {i, 0, kGridSize_m}, i == 0 ? kAxisZ : kGridColour);
        drawing.line({-kGridSize_m, 0, i}, {kGridSize_m, 0, i}, i == 0 ? kAxisX : kGridColour);
    }
}

// The directions of the world's axes, as the eye sees them, in the lower right corner of the image.
void draw_axes(const Context& context) {
    constexpr struct {
        const char* name;
        unsigned colour;
    } kAxes[] = {{"X", 0xff5050e0}, {"Y", 0xff50c060}, {"Z", 0xffe08050}};
    const Area& area = context.frame.image_area;
    const float length = context.ui(28), margin = context.ui(48);
    const ImVec2 centre{area.left + area.width - margin, area.top + area.height - margin};
    const glm::dmat3 eye_from_world = glm::transpose(glm::dmat3(world_from_eye(context.view.eye)));
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    std::array<int, 3> order{0, 1, 2};  // the farthest first
    std::sort(order.begin(), order.end(), [&](int a, int b) { return eye_from_world[a].z < eye_from_world[b].z; });
    for (const int axis : order) {
        const auto [name, colour] = kAxes[axis];
        const glm::vec2 at = length * glm::vec2(eye_from_world[axis]);
        const ImVec2 end{centre.x + at.x, centre.y - at.y}, size = ImGui::CalcTextSize(name);
        list.AddLine(centre, end, colour, context.ui(2));
        const ImVec2 letter{centre.x + 1.35f * at.x, centre.y - 1.35f * at.y};
        list.AddText({letter.x - size.x / 2, letter.y - size.y / 2}, colour, name);
    }
}

unsigned colour_of(const Context& context, uint32_t node) {
    return context.editor.selected() == node ? ui::kAccent : 0xffd8d4d0;
}

}  // namespace

ImVec2 in_window(const Context& context, glm::dvec2 pixel) {
    const Area& area = context.frame.image_area;
    return {area.left + static_cast<float>(pixel.x), area.top + static_cast<float>(pixel.y)};
}

void draw_line(const Context& context, glm::dvec3 a, glm::dvec3 b, unsigned colour, float width) {
    const auto pixels = editor::pixels_of(context.frame.camera, a, b);
    if (!pixels) return;
    ImGui::GetBackgroundDrawList()->AddLine(in_window(context, pixels->first), in_window(context, pixels->second),
                                            colour, context.ui(width));
}

namespace {

// A box in the world that grows.
struct GrowingBox {
    glm::dvec3 low{INFINITY}, high{-INFINITY};
    bool is_empty() const { return low.x > high.x; }
    void add(glm::dvec3 position) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    void add(const glm::dmat4& world, glm::dvec3 from, glm::dvec3 to) {
        for (int i = 0; i < 8; ++i)
            add(world * glm::dvec4(i & 1 ? to.x : from.x, i & 2 ? to.y : from.y, i & 4 ? to.z : from.z, 1));
    }
};

}  // namespace

std::optional<std::pair<glm::dvec3, glm::dvec3>> box_of_performers(const Context& context,
                                                                   const stage::EvaluatedStage& evaluated) {
    GrowingBox box;
    const auto& leaf_boxes = context.frame.rendered.leaf_boxes;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (performer.clip >= leaf_boxes.size()) return {};
        box.add(performer.world_from_performer, leaf_boxes[performer.clip].first, leaf_boxes[performer.clip].second);
    }
    if (box.is_empty()) return {};
    return std::pair(box.low, box.high);
}

std::pair<glm::dvec3, glm::dvec3> box_of_node(const Context& context, uint32_t node) {
    GrowingBox box;
    const auto is_in_subtree = [&](uint32_t candidate) {
        for (int64_t i = candidate; i >= 0; i = context.frame.stage->scene.nodes[static_cast<size_t>(i)].parent)
            if (i == node) return true;
        return false;
    };
    for (const stage::EvaluatedPerformer& performer : context.frame.evaluated.performers) {
        if (!is_in_subtree(context.frame.stage->performers[performer.performer].node)) continue;
        const auto& [from, to] = context.frame.rendered.leaf_boxes[performer.clip];
        box.add(performer.world_from_performer, from, to);
    }
    const stage::GltfScene& scene = context.frame.stage->scene;
    for (uint32_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].mesh < 0 || !is_in_subtree(i)) continue;
        for (const stage::GltfPrimitive& primitive : scene.meshes[static_cast<size_t>(scene.nodes[i].mesh)].primitives)
            for (const glm::vec3& position : primitive.positions)
                box.add(context.frame.evaluated.pose.world_from_node[i] * glm::dvec4(position, 1));
    }
    if (box.is_empty()) box.add(glm::dvec3(context.frame.evaluated.pose.world_from_node[node][3]));
    return {box.low, box.high};
}

void draw_scene_overlay(const Context& context) {
    const FrameInput& frame = context.frame;
    if (!frame.stage) return;
    Drawing drawing(context);
    if (context.view.grid) draw_grid(drawing);
    if (context.view.axes) draw_axes(context);
    if (context.view.panels.all) {
        for (const stage::EvaluatedLight& light : frame.evaluated.lights)
            drawing.icon(light.position, ICON_LIGHT, colour_of(context, light.node));
        for (const stage::EvaluatedCamera& camera : frame.evaluated.cameras)
            drawing.icon(glm::dvec3(camera.world_from_camera[3]), ICON_CAMERA, colour_of(context, camera.node));
    }
    if (context.editor.selected() && context.stage_of_document()) {
        const auto [low, high] = box_of_node(context, *context.editor.selected());
        drawing.box(low, high, ui::kAccentDim);
    }
}

void draw_handles(const Context& context, std::span<const HandleShape> shapes, int hot) {
    Drawing drawing(context);
    for (HandleShape shape : shapes) {
        if (hot != 0 && shape.handle == hot) shape.colour = kHotHandle;
        drawing.shape(shape);
    }
}

glm::dvec2 pointer_of(const Context& context) {
    const ImVec2 at = ImGui::GetIO().MousePos;
    return {at.x - context.frame.image_area.left, at.y - context.frame.image_area.top};
}

std::optional<uint32_t> icon_at(const Context& context, float x, float y) {
    if (!context.view.panels.all || !context.stage_of_document()) return std::nullopt;
    std::optional<uint32_t> found;
    const auto test = [&](glm::dvec3 position, uint32_t node) {
        const auto pixel = editor::pixel_of(context.frame.camera, position);
        if (!pixel) return;
        const ImVec2 icon = in_window(context, *pixel);
        if (std::hypot(icon.x - x, icon.y - y) < context.ui(12)) found = node;
    };
    for (const stage::EvaluatedLight& light : context.frame.evaluated.lights) test(light.position, light.node);
    for (const stage::EvaluatedCamera& camera : context.frame.evaluated.cameras)
        test(glm::dvec3(camera.world_from_camera[3]), camera.node);
    return found;
}

Eye eye_of(const stage::EvaluatedCamera& camera, const stage::Stage& stage, const stage::EvaluatedStage& evaluated) {
    const auto [low, high] = stage::performers_box(stage, evaluated);
    return looking_through(camera.world_from_camera, camera.vertical_angle_rad,
                           distance_to(camera.world_from_camera, low, high));
}

void focus(Context& context) {
    if (!context.frame.stage) return;
    const bool selected = context.editor.selected() && context.stage_of_document();
    auto [low, high] = stage::performers_box(*context.frame.stage, context.frame.evaluated);
    if (selected) {
        const auto [node_low, node_high] = box_of_node(context, *context.editor.selected());
        const bool is_point = node_low == node_high;  // a light or a camera: together with the performers
        low = is_point ? glm::min(low, node_low) : node_low;
        high = is_point ? glm::max(high, node_high) : node_high;
    }
    context.go_to(
        framed(context.view.eye, low, high, context.frame.image_area.width / context.frame.image_area.height));
}

void remember_view(Context& context) {
    if (!context.editor.is_open()) return;
    context.editor.edit([&](edit::Document& d) {
        return edit::add_camera(d.file, "view", context.view.eye.angle_y, world_from_eye(context.view.eye));
    });
}

}  // namespace neuvv::viewer
