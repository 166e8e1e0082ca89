// The box whose leaves are painted at once: its edges and six handles in the image. Part of PaintTool.
#include <imgui.h>

#include <algorithm>
#include <array>

#include "editor/pointer.h"
#include "tools/ui/theme.h"
#include "tools/viewer/context.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/paint_tool.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::viewer {

namespace {

constexpr double kMinSide_m = 0.01;
constexpr float kHandle = 4.5f, kGrab = 9;  // half sides, at scale 1
constexpr unsigned kAxisColours[] = {0xff5a5af0, 0xff6ecb5a, 0xfff0a05a};
constexpr const char* kSides[] = {"x-low", "y-low", "z-low", "x-high", "y-high", "z-high"};

struct Box {
    // The centre of a side.
    glm::dvec3 low, high;
    glm::dvec3 side(int axis, bool is_high) const {
        glm::dvec3 centre = 0.5 * (low + high);
        centre[axis] = is_high ? high[axis] : low[axis];
        return centre;
    }
};

void draw_edges(const Context& context, const Box& box, const glm::dmat4& world_from_performer) {
    const auto corner = [&](int i) {
        const glm::dvec3 at((i & 1) ? box.high.x : box.low.x, (i & 2) ? box.high.y : box.low.y,
                            (i & 4) ? box.high.z : box.low.z);
        return glm::dvec3(world_from_performer * glm::dvec4(at, 1));
    };
    for (int i = 0; i < 8; ++i)
        for (const int step : {1, 2, 4}) {
            if (i & step) continue;
            draw_line(context, corner(i), corner(i | step), 0x80000000, 3);
            draw_line(context, corner(i), corner(i | step), ui::kAccent, 1.25f);
        }
}

}  // namespace

void PaintTool::fit_box(const Context& context) {
    const auto performer = this->performer(context);
    if (!performer || !clip_ || clip_file_ != performer->place.segment().file) return;
    std::tie(settings.box_low, settings.box_high) = voctree::occupied_box(clip_->tree);
}

bool PaintTool::drag_box(Context& context, const PaintedPerformer& performer, bool pointer_used) {
    if (settings.box_low == settings.box_high) fit_box(context);
    Box box{settings.box_low, settings.box_high};
    const glm::dvec2 pointer = pointer_of(context);
    const auto along_axis = [&](int axis, bool high, double grabbed) {
        Box from = box;
        (high ? from.high : from.low)[axis] = grabbed;
        const glm::dvec3 through(performer.world_from_performer * glm::dvec4(from.side(axis, high), 1));
        return editor::line_drag(context.frame.camera, through, glm::dvec3(performer.world_from_performer[axis]), 0.25,
                                 pointer);
    };
    if (box_drag_ && !ImGui::IsMouseDown(ImGuiMouseButton_Left)) box_drag_.reset();
    if (box_drag_) {
        if (const auto s = along_axis(box_drag_->axis, box_drag_->high, box_drag_->grabbed)) {
            const double to = box_drag_->grabbed + *s - box_drag_->s;
            const int axis = box_drag_->axis;
            if (box_drag_->high)
                settings.box_high[axis] = std::max(to, box.low[axis] + kMinSide_m);
            else
                settings.box_low[axis] = std::min(to, box.high[axis] - kMinSide_m);
        }
        box = {settings.box_low, settings.box_high};
    }
    draw_edges(context, box, performer.world_from_performer);
    std::optional<int> over;
    for (int i = 0; i < 6; ++i) {
        const auto at = editor::pixel_of(
            context.frame.camera, glm::dvec3(performer.world_from_performer * glm::dvec4(box.side(i % 3, i >= 3), 1)));
        if (!at) continue;
        const ImVec2 centre = in_window(context, *at);
        const bool near = glm::length(*at - pointer) < double{context.ui(kGrab)};
        if (near && context.frame.pointer_in_image && !pointer_used && !over) over = i;
        const bool active = box_drag_ ? box_drag_->axis == i % 3 && box_drag_->high == (i >= 3) : over == i;
        const float half = context.ui(active ? kHandle + 1.5f : kHandle);
        ImDrawList* list = ImGui::GetBackgroundDrawList();
        list->AddRectFilled({centre.x - half, centre.y - half}, {centre.x + half, centre.y + half},
                            active ? 0xffffffff : kAxisColours[i % 3], context.ui(1));
        list->AddRect({centre.x - half, centre.y - half}, {centre.x + half, centre.y + half}, 0xc0000000,
                      context.ui(1));
        context.report.area(std::string("paint/box/") + kSides[i], centre.x - half, centre.y - half, 2 * half,
                            2 * half);
    }
    if (over && !box_drag_ && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
        const int axis = *over % 3;
        const bool high = *over >= 3;
        const double grabbed = high ? box.high[axis] : box.low[axis];
        if (const auto s = along_axis(axis, high, grabbed)) box_drag_ = BoxDrag{axis, high, grabbed, *s};
    }
    return over || box_drag_;
}

}  // namespace neuvv::viewer
