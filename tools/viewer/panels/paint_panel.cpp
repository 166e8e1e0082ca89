// The tab of paint: what a brush, a box or an image does, at which frames, and the layers of the performer.
#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>

#include "edit/operations.h"
#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/property_fields.h"

namespace neuvv::viewer {

namespace {

using Brush = PaintSettings::Tool;
using Frames = PaintSettings::Frames;

constexpr const char* kBlends[] = {"Normal", "Multiply", "Tint", "Recolour"};
constexpr const char* kFrames[] = {"This frame", "A range", "The whole clip"};
constexpr const char* kFollows[] = {"Only then", "As long as it stays", "Whenever it is there"};
constexpr const char* kFollowTooltips[] = {
    "The edit holds at these frames and no others.",
    "The edit also holds before and after these frames, as long as the surface stays where it was painted.",
    "The edit holds in every frame in which there is a surface where it was painted."};

struct ToolIcon {
    const char *name, *icon, *tooltip, *title;
};
constexpr ToolIcon kTools[] = {
    {"paint/colour", ICON_BRUSH, "Colour: paint over what is there (Ctrl erases)", "Colour"},
    {"paint/erase", ICON_ERASER, "Erase: take away what is there", "Erase"},
    {"paint/shift", ICON_TINT, "Hue and saturation: shift the colours that are there", "Hue and saturation"},
    {"paint/restore", ICON_UNDO, "Restore: take this layer's paint off again", "Restore"},
    {"paint/stamp", ICON_STAMP, "Image: project a PNG from where you look", "Image"}};

void tool_row(Context& context, PaintSettings& settings) {
    for (size_t i = 0; i < std::size(kTools); ++i) {
        if (i > 0) ImGui::SameLine();
        const ToolIcon& tool = kTools[i];
        const bool on = settings.tool == static_cast<Brush>(i) && PaintTool::is_current(context);
        if (icon_button(context, tool.name, tool.icon, tool.tooltip, on)) {
            settings.tool = static_cast<Brush>(i);
            context.view.mode = &PaintTool::kMode;
        }
    }
}

void brush_fields(PaintTool& paint, FieldGroup& fields) {
    PaintSettings& settings = paint.settings;
    double radius_cm = 100 * settings.radius_m;
    if (fields.number("Radius", radius_cm, {100 * kMinRadius_m, 100 * kMaxRadius_m, 0.05, "%.1f cm"}))
        settings.radius_m = radius_cm / 100;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("[ and ] in the image make it smaller and larger");
    fields.slider("Hardness", settings.hardness, 0, 1);
}

void box_fields(Context& context, PaintTool& paint, FieldGroup& fields) {
    PaintSettings& settings = paint.settings;
    const FieldGroup::NumberOptions metres{-1000, 1000, 0.005, "%.2f"};
    fields.number("Low corner", settings.box_low, metres);
    fields.number("High corner", settings.box_high, metres);
    settings.box_high = glm::max(settings.box_high, settings.box_low);
    fields.label("");
    if (ImGui::Button("Around all", {-FLT_MIN, 0})) paint.fit_box(context);
    fields.report_last("Around all");
    constexpr const char* kDo[] = {"Paint the box", "Erase the box", "Shift the box", "Restore the box"};
    fields.label("");
    ImGui::BeginDisabled(paint.busy());
    if (ImGui::Button(kDo[std::min<size_t>(static_cast<size_t>(settings.tool), 3)], {-FLT_MIN, 0}))
        paint.paint_in_box(context);
    fields.report_last("Do");
    ImGui::EndDisabled();
}

void stamp_fields(Context& context, PaintTool& paint, Files& files, FieldGroup& fields) {
    PaintSettings& settings = paint.settings;
    if (fields.text("File", settings.image)) paint.load_image(context);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("A PNG. Enter reads it; then it hangs on the pointer");
    fields.label("");
    if (ImGui::Button(ICON_FOLDER "  Choose…", {-FLT_MIN, 0}))
        files.ask_path("Image", {".png"}, false, "", [&context, &paint](const std::filesystem::path& path) {
            paint.settings.image = path.string();
            paint.load_image(context);
        });
    fields.report_last("Choose");
    double percent = 100 * settings.stamp_share;
    if (fields.slider("Height", percent, 100 * kMinStamp, 100 * kMaxStamp, "%.0f %% of the view"))
        settings.stamp_share = percent / 100;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Ctrl and the wheel in the image change it, too");
    fields.slider("Opacity", settings.opacity, 0, 1);
    if (!settings.image.empty() && paint.stamp_loaded()) ImGui::TextDisabled("Click in the view to project it.");
}

void tool_fields(Context& context, PaintTool& paint, Files& files) {
    PaintSettings& settings = paint.settings;
    FieldGroup fields(context, "paint");
    if (settings.tool == Brush::kStamp) return stamp_fields(context, paint, files, fields);
    constexpr const char* kWith[] = {"A brush", "A box"};
    size_t with = settings.in_box;
    if (fields.choice("With", with, kWith)) settings.in_box = with == 1;
    if (settings.tool == Brush::kColour) {
        fields.colour("Colour", settings.colour);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("Alt and a click in the view take the colour there");
    }
    if (settings.tool == Brush::kShift) {
        fields.slider("Hue", settings.hue_degrees, -180, 180, "%.0f°");
        fields.slider("Saturation", settings.saturation, 0, 3);
    }
    if (settings.tool == Brush::kColour || settings.tool == Brush::kShift)
        fields.slider("Opacity", settings.opacity, 0, 1);
    settings.in_box ? box_fields(context, paint, fields) : brush_fields(paint, fields);
}

void frame_fields(Context& context, PaintTool& paint, const PaintedPerformer& performer) {
    PaintSettings& settings = paint.settings;
    FieldGroup fields(context, "paint");
    auto frames = static_cast<size_t>(settings.frames);
    const double last = performer.frames - 1.0;
    if (fields.choice("Frames", frames, kFrames)) {
        settings.frames = static_cast<Frames>(frames);
        settings.first = static_cast<int>(performer.frame);
        settings.last = static_cast<int>(last);
    }
    if (settings.frames == Frames::kRange) {
        double from = settings.first, to = settings.last;
        if (fields.number("From", from, {0, last, 0.2, "%.0f"})) settings.first = static_cast<int>(from);
        if (fields.number("To", to, {0, last, 0.2, "%.0f"})) settings.last = static_cast<int>(to);
    }
    if (settings.tool == Brush::kStamp && settings.frames != Frames::kThis) {
        fields.toggle("On each frame", settings.every_frame);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("As a projector would: onto each frame's own surface. Takes longer.");
        if (settings.every_frame) return;
    }
    if (settings.frames == Frames::kAll) return;
    auto follow = static_cast<size_t>(settings.follow);
    if (fields.choice("Holds", follow, kFollows)) settings.follow = static_cast<edit::Follow>(follow);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", kFollowTooltips[static_cast<size_t>(settings.follow)]);
}

void set_layer(Context& context, uint32_t node, size_t layer, const edit::PaintEdit& edit, bool is_drag = false) {
    const auto operation = [&](edit::Document& document) {
        return edit::set_paint_layer(document.file, node, layer, edit);
    };
    is_drag ? context.editor.drag(operation) : context.editor.edit(operation);
}

void layer_buttons(Context& context, PaintTool& paint, const PaintedPerformer& performer, size_t painted) {
    const size_t count = performer.layers.size();
    const uint32_t node = performer.node;
    const bool any = count > 0 && !paint.busy();
    if (icon_button(context, "paint/layer-new", ICON_PLUS, "A new layer on top", false, !paint.busy()))
        paint.add_layer(context);
    const auto move_to = [&](size_t to) {
        paint.settings.layer = performer.layers[painted].path;
        context.editor.edit(
            [&](edit::Document& document) { return edit::move_paint_layer(document.file, node, painted, to); });
    };
    ImGui::SameLine();
    if (icon_button(context, "paint/layer-up", ICON_UP, "Over the next one", false, any && painted + 1 < count))
        move_to(painted + 1);
    ImGui::SameLine();
    if (icon_button(context, "paint/layer-down", ICON_DOWN, "Under the next one", false, any && painted > 0))
        move_to(painted - 1);
    ImGui::SameLine();
    if (icon_button(context, "paint/layer-delete", ICON_TRASH, "Take the layer off this performer; its file stays",
                    false, any))
        context.editor.edit(
            [&](edit::Document& document) { return edit::remove_paint_layer(document.file, node, painted); });
}

// The uppermost layer first.
void layer_rows(Context& context, PaintTool& paint, const PaintedPerformer& performer, size_t painted) {
    if (performer.layers.empty()) ImGui::TextDisabled("None yet: the first stroke makes one.");
    for (size_t i = performer.layers.size(); i-- > 0;) {
        const edit::ListedLayer& layer = performer.layers[i];
        const std::string title = edit::title_of(layer), name = "paint/layer/" + title;
        ImGui::PushID(static_cast<int>(i));
        if (icon_button(context, (name + "/eye").c_str(), layer.entry.visible ? ICON_EYE : ICON_EYE_OFF,
                        layer.entry.visible ? "Hide the layer" : "Show the layer"))
            set_layer(context, performer.node, i, {.visible = !layer.entry.visible});
        ImGui::SameLine();
        if (!layer.entry.visible) ImGui::PushStyleColor(ImGuiCol_Text, ui::kFaint);
        ImGui::PushStyleVar(ImGuiStyleVar_SelectableTextAlign, {0, 0.5f});
        if (ImGui::Selectable(title.c_str(), i == painted, 0, {0, ImGui::GetFrameHeight()}))
            paint.settings.layer = layer.path;
        ImGui::PopStyleVar();
        if (!layer.entry.visible) ImGui::PopStyleColor();
        context.report.item(name);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s\n%s, opacity %.2f", layer.path.filename().c_str(),
                              kBlends[static_cast<size_t>(layer.entry.blend)], layer.entry.opacity);
        ImGui::PopID();
    }
}

void layer_fields(Context& context, const PaintedPerformer& performer, size_t painted) {
    if (painted >= performer.layers.size()) return;
    const edit::ListedLayer& layer = performer.layers[painted];
    FieldGroup fields(context, "layer");
    std::string name = edit::title_of(layer);
    if (fields.text("Name", name)) set_layer(context, performer.node, painted, {.name = name});
    double opacity = layer.entry.opacity;
    if (fields.slider("Opacity", opacity, 0, 1))
        set_layer(context, performer.node, painted, {.opacity = opacity}, true);
    auto blend = static_cast<size_t>(layer.entry.blend);
    if (fields.choice("Blend", blend, kBlends))
        set_layer(context, performer.node, painted, {.blend = static_cast<stage::PaintBlend>(blend)});
}

}  // namespace

void paint_tab(Context& context, PaintTool& paint, Files& files) {
    tool_row(context, paint.settings);
    const auto performer = PaintTool::performer(context);
    if (!performer) {
        ImGui::Spacing();
        ImGui::TextWrapped("Select a performer to paint it.");
        return;
    }
    headline(kTools[static_cast<size_t>(paint.settings.tool)].title);
    tool_fields(context, paint, files);
    headline("When");
    frame_fields(context, paint, *performer);
    headline(fmt::format("Layers of {}", performer->name).c_str());
    const size_t painted = paint.painted_layer(*performer);
    layer_buttons(context, paint, *performer, painted);
    layer_rows(context, paint, *performer, painted);
    layer_fields(context, *performer, painted);
}

}  // namespace neuvv::viewer
