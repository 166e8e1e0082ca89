// A tool: what the mouse and the keys do in the image.
//
// A new tool is a class in a file of its own and a line in make_tools() (tools.cpp). Its modes become buttons of the
// toolbar, with their keys.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "tools/viewer/context.h"

namespace neuvv::viewer {

// A button of the toolbar: what the pointer does in the image while it is the current one.
struct ToolMode {
    const char* name;  // of the button in reports: "tool/move"
    const char* icon;
    const char* tooltip;  // the tooltip
    int key;              // of GLFW, chooses the mode; 0: none
};

// What of the pointer is in use, so that later tools leave it alone.
struct PointerUse {
    bool left = false;  // the left button: something is under the pointer, or is dragged
    bool wheel = false;
    bool all = false;  // the image shall not be moved by anything
};

class Tool {
  public:
    Tool() = default;
    Tool(const Tool&) = delete;
    Tool& operator=(const Tool&) = delete;
    virtual ~Tool() = default;

    // None for a tool that works in every mode.
    virtual std::span<const ToolMode> modes() const { return {}; }
    // A key that was pressed while nothing is typed and no handle is dragged.
    virtual void key(Context&, const ui::KeyPress&) {}
    // Each frame: the pointer in the image. `use` is what tools before this one use of it; adds what this one uses.
    virtual void pointer(Context& context, PointerUse& use) = 0;
    // A button is down that this tool answers, wherever the pointer goes: it comes before all other tools.
    virtual bool captures_pointer() const { return false; }
    // It changes the document: until that is over, keys do nothing and the drag of the document does not end.
    virtual bool is_editing() const { return false; }
    // Another document was opened: whatever is dragged is dropped.
    virtual void document_opened() {}
    // Draws over the image, after all tools have seen the pointer.
    virtual void overlay(Context&) {}
};

}  // namespace neuvv::viewer
