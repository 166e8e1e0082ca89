// The interface of tools: what the mouse and the keys do in the image.
//
// A new tool is a class in a file of its own and an entry of the table in the constructor of Tools (tools.cpp). Each of
// its modes gets a button of the toolbar and a key.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "tools/viewer/context.h"

namespace neuvv::viewer {

// What the pointer does in the image while this is the current mode, and its button in the toolbar.
struct ToolMode {
    const char* name;  // of its button in reports, as "tool/move"
    const char* icon;
    const char* tooltip;
    int key;  // GLFW's number of the key that selects this mode; 0: none
};

// Which parts of the pointer a tool uses in this frame, so that later tools leave them alone.
struct PointerUse {
    bool left = false;  // the left button: it would grab what is under the pointer, or is dragging
    bool wheel = false;
    bool all = false;  // everything: the eye must not move
};

class Tool {
  public:
    Tool() = default;
    Tool(const Tool&) = delete;
    Tool& operator=(const Tool&) = delete;
    virtual ~Tool() = default;

    // Empty for a tool that works in every mode.
    virtual std::span<const ToolMode> modes() const { return {}; }
    // A key was pressed. It is not called while text is typed, while a popup is open, or while a tool is editing.
    virtual void handle_key(Context&, const ui::KeyPress&) {}
    // Called once a frame for the pointer in the image. `use` says what earlier tools use; the tool adds what it uses.
    virtual void handle_pointer(Context& context, PointerUse& use) = 0;
    // Whether the tool is dragging: it then comes before all other tools, wherever the pointer goes.
    virtual bool captures_pointer() const { return false; }
    // Whether the tool is changing the document. Meanwhile keys do nothing, and Editor::end_drag() is not called.
    virtual bool is_editing() const { return false; }
    // Another document is being opened: the tool forgets its drag.
    virtual void document_opened() {}
    // Draws over the image, once the pointer has been given to all tools.
    virtual void overlay(Context&) {}
};

}  // namespace neuvv::viewer
