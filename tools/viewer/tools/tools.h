// All tools of the viewer, and what the frame loop does with them.
#pragma once

#include "tools/viewer/tools/tool.h"

namespace neuvv::viewer {

class PaintTool;

std::unique_ptr<Tool> make_gizmo_tool();     // moves, turns and scales the selected node
std::unique_ptr<Tool> make_light_tool();     // aims and opens the selected light
std::unique_ptr<Tool> make_navigate_tool();  // moves the eye, selects by clicks

class Tools {
  public:
    // `paint` belongs to the panel of painting, too.
    explicit Tools(PaintTool& paint);

    // The mode in which the viewer begins.
    const ToolMode& first_mode() const { return all_.front()->modes().front(); }
    // Buttons of all modes, and of how handles behave, at the image's left.
    void toolbar(Context& context) const;
    // A key that was pressed while nothing is typed.
    void key(Context& context, const ui::KeyPress& press);
    // Each frame: the pointer in the image; then what is drawn over the image.
    void pointer(Context& context);
    // Whether one of them is changing the document.
    bool edit() const;
    void document_opened();

  private:
    std::vector<std::unique_ptr<Tool>> owned_;
    std::vector<Tool*> all_;
};

}  // namespace neuvv::viewer
