// All tools of the viewer, as the frame loop uses them.
#pragma once

#include "tools/viewer/tools/tool.h"

namespace neuvv::viewer {

class PaintTool;

std::unique_ptr<Tool> make_gizmo_tool();     // moves, rotates and scales the selected node
std::unique_ptr<Tool> make_light_tool();     // changes the aim, the cone and the range of the selected light
std::unique_ptr<Tool> make_navigate_tool();  // moves the eye; selects what is clicked

class Tools {
  public:
    // `paint` is passed in because the panel of painting uses it, too. It must outlive this object.
    explicit Tools(PaintTool& paint);

    // The mode in which the viewer begins.
    const ToolMode& first_mode() const { return all_.front()->modes().front(); }
    // Draws the buttons of all modes and those of the settings of handles, at the left of the image.
    void toolbar(Context& context) const;
    // A key was pressed (see Tool::handle_key).
    void handle_key(Context& context, const ui::KeyPress& press);
    // Called once a frame: gives the pointer to the tools, then draws the overlays.
    void handle_pointer(Context& context);
    // Whether a tool is changing the document.
    bool is_editing() const;
    void document_opened();

  private:
    std::vector<std::unique_ptr<Tool>> owned_;  // all but `paint`
    std::vector<Tool*> all_;                    // the first one has precedence
};

}  // namespace neuvv::viewer
