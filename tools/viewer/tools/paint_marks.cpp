// The brush and the stamp under the pointer, projecting the stamp, and taking a colour from the image. Part of
// PaintTool.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "editor/paint/paint_task.h"
#include "editor/pointer.h"
#include "media/colour.h"
#include "render/volume/trace.h"
#include "tools/ui/theme.h"
#include "tools/viewer/context.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/paint_tool.h"

namespace neuvv::viewer {

namespace {

constexpr uint32_t kPreviewCells = 40;  // of the stamp's preview, along its longer side
constexpr double kPixelsPerPixel = 2;   // the most pixels of a projected image per pixel of the window, along each side

ImVec4 colour_of(const uint8_t* rgba) {
    return {static_cast<float>(rgba[0]) / 255, static_cast<float>(rgba[1]) / 255, static_cast<float>(rgba[2]) / 255,
            static_cast<float>(rgba[3]) / 255};
}

// A light ring over a dark one, which is visible on any image.
void ring(ImDrawList* list, ImVec2 at, float radius, unsigned colour, float width) {
    list->AddCircle(at, radius, 0xa0000000, 0, width + 2);
    list->AddCircle(at, radius, colour, 0, width);
}

// The factor of downscaling that leaves at most `max` pixels along the longer side.
uint32_t factor_for(const media::Image& image, double max) {
    const double longest = std::max(image.width, image.height);
    return static_cast<uint32_t>(std::max(1.0, std::ceil(longest / std::max(max, 1.0))));
}

// The camera that sees what `camera` shows in a part of its image, with an image of this size.
stage::Camera part_of(stage::Camera camera, const Area& part, uint32_t width, uint32_t height) {
    const double across = width / double{part.width}, down = height / double{part.height};
    camera.fx *= across;
    camera.fy *= down;
    camera.cx = (camera.cx - double{part.left}) * across;
    camera.cy = (camera.cy - double{part.top}) * down;
    camera.width = width;
    camera.height = height;
    return camera;
}

}  // namespace

void PaintTool::draw_brush(const Context& context, const PaintedPerformer& performer) const {
    const glm::dmat3 axes(performer.world_from_performer);
    const double scale = (glm::length(axes[0]) + glm::length(axes[1]) + glm::length(axes[2])) / 3;
    const auto radius = static_cast<float>(settings.radius_m * scale * context.frame.camera.fy /
                                           std::max(hover_.depth_m, editor::kMinDepth_m));
    const ImGuiIO& io = ImGui::GetIO();
    const bool erases =
        settings.tool == PaintSettings::Tool::kErase || (settings.tool == PaintSettings::Tool::kColour && io.KeyCtrl);
    const glm::dvec3 srgb = glm::clamp(media::srgb_from_linear(settings.colour), 0.0, 1.0);
    unsigned colour = 0xffffffff;
    if (erases) colour = ui::kWarning;
    if (!erases && settings.tool == PaintSettings::Tool::kColour)
        colour = ImGui::ColorConvertFloat4ToU32(
            {static_cast<float>(srgb.r), static_cast<float>(srgb.g), static_cast<float>(srgb.b), 1});
    const bool is_off_surface = !hover_.world && !stroke_;
    if (is_off_surface) colour = (colour & 0xffffff) | 0x70000000;
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    ring(list, io.MousePos, std::max(radius, 2.0f), colour, context.ui(1.5f));
    if (settings.hardness < 0.99 && radius > context.ui(12))
        list->AddCircle(io.MousePos, radius * static_cast<float>(settings.hardness), (colour & 0xffffff) | 0x60000000);
}

// The displayed colour, light included.
void PaintTool::take_colour(Context& context) {
    const glm::dvec2 pixel = glm::max(pointer_of(context), glm::dvec2(0));
    context.render_thread.post([this, &context, pixel](editor::OnDevice& on_device) {
        const auto image = context.render_thread.state().displayed.image;
        if (!image) return;
        const VkOffset2D at{static_cast<int32_t>(std::min(pixel.x, image->shape.width - 1.0)),
                            static_cast<int32_t>(std::min(pixel.y, image->shape.height - 1.0))};
        const gpu::Buffer taken(on_device.device, "taken colour", 4, gpu::MemoryKind::kReadback);
        gpu::run_once(on_device.device, "take a colour", [&](gpu::Commands& commands) {
            gpu::full_barrier(commands);
            gpu::copy(commands, *image, {at, {1, 1}}, taken);
            gpu::host_barrier(commands);
        });
        const uint8_t* rgba = taken.as<uint8_t>();
        const glm::dvec3 linear(media::linear_from_srgb_byte(rgba[0]), media::linear_from_srgb_byte(rgba[1]),
                                media::linear_from_srgb_byte(rgba[2]));
        context.jobs.post([this, linear] { settings.colour = linear; });
    });
}

void PaintTool::load_image(Context& context) {
    context.jobs.start("Reading an image", [this, &context, path = settings.image]() -> JobQueue::Then {
        const auto image = std::make_shared<const media::Image>(media::read_png(path));
        const auto preview =
            std::make_shared<const media::Image>(editor::downscaled(*image, factor_for(*image, kPreviewCells)));
        return [this, &context, path, image, preview] {
            stamp_path_ = path;
            stamp_ = image;
            stamp_preview_ = preview;
            context.redraw();
        };
    });
}

// The centre of the stamp is at the pointer.
Area PaintTool::stamp_area(const Context& context) const {
    const ImVec2 at = ImGui::GetIO().MousePos;
    Area area;
    area.height = static_cast<float>(settings.stamp_share) * context.frame.image_area.height;
    area.width = area.height * static_cast<float>(stamp_->width) / static_cast<float>(stamp_->height);
    area.left = at.x - 0.5f * area.width;
    area.top = at.y - 0.5f * area.height;
    return area;
}

void PaintTool::draw_stamp(Context& context) const {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const media::Image& cells = *stamp_preview_;
    const Area area = stamp_area(context);
    if (!task_runs_) {
        const float width = area.width / static_cast<float>(cells.width),
                    height = area.height / static_cast<float>(cells.height);
        for (uint32_t y = 0; y < cells.height; ++y)
            for (uint32_t x = 0; x < cells.width; ++x) {
                ImVec4 colour = colour_of(cells.at(x, y));
                colour.w *= 0.75f * static_cast<float>(settings.opacity);
                const ImVec2 low(area.left + width * static_cast<float>(x), area.top + height * static_cast<float>(y));
                list->AddRectFilled(low, {low.x + width, low.y + height}, ImGui::ColorConvertFloat4ToU32(colour));
            }
        list->AddRect({area.left, area.top}, {area.left + area.width, area.top + area.height}, 0xc0ffffff, 0, 0,
                      context.ui(1));
    } else {
        list->AddText({area.left, area.top}, 0xffffffff, "Projecting…");
    }
    context.report.area("paint/stamp-area", area.left, area.top, area.width, area.height);
}

void PaintTool::project_stamp(Context& context, const PaintedPerformer& performer) {
    const auto target = open_target(context, performer);
    if (!target) return;
    begin_task(context);
    context.view.clock.pause();
    Area area = stamp_area(context);
    const uint32_t factor = factor_for(*stamp_, kPixelsPerPixel * double{std::max(area.width, area.height)});
    area.left -= context.frame.image_area.left;
    area.top -= context.frame.image_area.top;
    const stage::Camera camera = render::in_performer(context.frame.camera, glm::mat4(performer.world_from_performer));
    editor::PaintOperation operation;
    operation.opacity = static_cast<float>(settings.opacity);
    operation.frames = frames_of(performer);
    const edit::EditFrames of_clip = operation.frames;
    const bool every_frame = settings.every_frame && settings.frames != PaintSettings::Frames::kThis;
    const editor::PaintPlace& place = performer.place;
    const editor::SeenPaint seen = editor::seen_paint(place, *clip_, target->before, of_clip, !every_frame);
    operation.frames = seen.frames;
    if (!seen.has_frames()) {
        task_runs_ = false;
        context.editor.notify("the frames are in other segments: go to one of them", true);
        return;
    }
    auto session = std::make_shared<std::optional<editor::PaintSession>>();
    editor::post_paint_task(
        context.parts(), surface_, place.segment().file, clip_,
        [=, this, &context, target = *target, image = stamp_, subject = subject_of(context, performer, false)](
            editor::PaintSurface& surface,
            const std::shared_ptr<const render::Field>& field) mutable -> JobQueue::Then {
            if (!*session) {
                subject.field = field;
                editor::PaintArea projection;
                projection.image = editor::downscaled(*image, factor);
                projection.image_camera = part_of(camera, area, projection.image.width, projection.image.height);
                projection.every_frame = every_frame;
                session->emplace(subject, seen.before, operation, std::move(projection));
            }
            if ((*session)->add_projection(surface)) return {};
            editor::Layer layer = (*session)->layer();
            std::optional<editor::SpreadPaint> spread;
            if (seen.is_carried) {
                const editor::CarriedPaint all =
                    editor::carry_on(performer.place, subject.clip, target.before, layer, of_clip);
                layer = all.layer;
                if (all.carrier) spread = editor::spread_edits(all.carrier);
            }
            return [=, this, &context] { write_result(context, performer, target, layer, "image projected", spread); };
        },
        [this] {
            clip_.reset();
            task_runs_ = false;
        });
}

}  // namespace neuvv::viewer
