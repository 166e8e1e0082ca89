// What one frame of the viewer reads: time, keys, the state of the render thread, the stage at the time of the clock,
// and the part of the window that shows the image. The Viewer writes it; panels and tools only read it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "editor/draw/render_thread.h"
#include "stage/evaluated_stage.h"
#include "tools/ui/window.h"
#include "tools/viewer/tools/navigation.h"

namespace neuvv::viewer {

// A rectangle of the window, in pixels of its framebuffer.
struct Area {
    float left = 0, top = 0, width = 0, height = 0;
    bool contains(float x, float y) const { return x >= left && y >= top && x < left + width && y < top + height; }
};

struct FrameInput {
    double now_s = 0, dt_s = 0;     // seconds since the viewer began, and since the previous frame
    std::optional<double> event_s;  // when the first event of this frame came, as now_s; nullopt: no event

    std::span<const ui::KeyPress> presses;
    std::u32string typed;    // the characters that were typed
    bool escape = false;     // Escape was pressed
    FlightKeys flight_keys;  // those that are down

    editor::RenderThreadState rendered;         // the state of the render thread when the frame began
    std::shared_ptr<const stage::Stage> stage;  // the newest stage that the render thread has read; null: none yet
    stage::EvaluatedStage evaluated;            // that stage at StageClock::displayed_s()

    float ui_scale = 1;             // pixels of the framebuffer per pixel at scale 1
    Area image_area;                // the part of the window that shows the image, beside the panels
    stage::Camera camera;           // the camera of the eye, for an image as large as image_area
    bool pointer_in_image = false;  // the pointer is over the image, and not over a panel or popup
};

}  // namespace neuvv::viewer
