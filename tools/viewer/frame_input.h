// What one frame of the viewer begins with: time, keys, the render thread's state, the stage at the clock's time, and
// where the image is. Viewer::frame() writes it; panels and tools only read it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "editor/render_thread.h"
#include "stage/evaluated_stage.h"
#include "tools/ui/window.h"
#include "tools/viewer/tools/navigation.h"

namespace neuvv::viewer {

// A part of the window, in pixels of its framebuffer.
struct Area {
    float left = 0, top = 0, width = 0, height = 0;
    bool holds(float x, float y) const { return x >= left && y >= top && x < left + width && y < top + height; }
};

struct FrameInput {
    double now_s = 0, dt_s = 0;     // of the viewer's clock: now, and since the frame before
    std::optional<double> event_s;  // when the first event of this frame came; none where none did

    std::span<const ui::KeyPress> presses;
    std::u32string typed;    // characters
    bool escape = false;     // Escape was pressed
    FlightKeys flight_keys;  // that are down

    editor::RenderThreadState drawn;            // what the render thread has, as of the frame's beginning
    std::shared_ptr<const stage::Stage> stage;  // drawn.stage; null: none was read yet
    stage::EvaluatedStage evaluated;            // that stage at the time that the clock displays

    float ui_scale = 1;             // pixels of the framebuffer by pixels at scale 1
    Area image_area;                // the part of the window that shows the image, beside the panels
    stage::Camera camera;           // that the image is seen by; as large as image_area
    bool pointer_in_image = false;  // the pointer is over the image and over no panel or popup
};

}  // namespace neuvv::viewer
