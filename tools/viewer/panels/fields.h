// Widgets that the panels share: fields with a name at the left and a value at the right, which are reported as
// "PANEL/NAME"; buttons with icons; items of menus.
//
// Each field returns whether its value was changed in this frame. For numbers, colours and sliders, call Editor::drag
// with an operation that sets the value: the viewer makes the drag one step of the history when the field is released.
// Toggles, choices and texts change at once: call Editor::edit.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>

#include "tools/viewer/context.h"

namespace neuvv::viewer {

// The fields of a panel. `name` is the PANEL of their reports.
class FieldGroup {
  public:
    FieldGroup(Context& context, std::string name);
    ~FieldGroup();
    FieldGroup(const FieldGroup&) = delete;
    FieldGroup& operator=(const FieldGroup&) = delete;

    struct NumberOptions {
        double low = -1e9, high = 1e9;
        double step = 0.01;           // the change per pixel of a drag
        const char* format = "%.3f";  // with the unit, as "%.2f m"
    };
    bool number(const char* name, double& value, const NumberOptions& options);
    bool number(const char* name, glm::dvec3& value, const NumberOptions& options);  // three in a row
    bool colour(const char* name, glm::dvec3& linear);                               // at least 0; displayed as sRGB
    bool toggle(const char* name, bool& value);
    bool choice(const char* name, size_t& value, std::span<const char* const> of);
    bool text(const char* name, std::string& value);  // changes with Enter, or when the field loses the focus
    bool slider(const char* name, double& value, double low, double high, const char* format = "%.2f");
    // For other widgets: draws the name and places the next widget beside it. Call report_last() after that widget.
    void label(const char* name);
    void report_last(const char* name);

  private:
    Context& context_;
    std::string name_;
};

// A button with an icon and a tooltip. `on`: it is highlighted as the selected one. Reported by `name`.
bool icon_button(Context& context, const char* name, const char* icon, const char* tooltip, bool on = false,
                 bool enabled = true);

// A button with a text, `width` pixels wide, or as wide as its text for 0. Reported by `name`.
bool text_button(Context& context, const char* name, const char* text, bool enabled = true, float width = 0);

// An item of a menu, reported by `report`. `keys` is the text at its right. Returns whether it was clicked.
bool menu_item(Context& context, const std::string& report, const char* text, const char* keys = nullptr,
               bool on = false, bool enabled = true);

}  // namespace neuvv::viewer
