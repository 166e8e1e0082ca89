// Fields of panels: a name left, a value right, reported as "PANEL/NAME".
//
// Each says whether its value was changed in this frame: then call Editor::drag with an operation that sets it, which
// the viewer makes one step of the history when the field is let go; a toggle, a choice or a text is changed once: call
// Editor::edit.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>

#include "tools/viewer/context.h"

namespace neuvv::viewer {

// Between them, fields are reported under this name.
class FieldGroup {
  public:
    FieldGroup(Context& context, std::string name);
    ~FieldGroup();
    FieldGroup(const FieldGroup&) = delete;
    FieldGroup& operator=(const FieldGroup&) = delete;

    struct NumberOptions {
        double low = -1e9, high = 1e9;
        double step = 0.01;           // a pixel of a drag
        const char* format = "%.3f";  // with its unit: "%.2f m"
    };
    bool number(const char* name, double& value, const NumberOptions& options);
    bool number(const char* name, glm::dvec3& value, const NumberOptions& options);  // three in a row
    bool colour(const char* name, glm::dvec3& linear);                               // 0 and more; shown as sRGB
    bool toggle(const char* name, bool& value);
    bool choice(const char* name, size_t& value, std::span<const char* const> of);
    bool text(const char* name, std::string& value);  // changed with Enter, or when the field is left
    bool slider(const char* name, double& value, double low, double high, const char* format = "%.2f");
    // The next widget's place, for one that is none of these; report_last after it.
    void label(const char* name);
    void report_last(const char* name);

  private:
    Context& context_;
    std::string name_;
};

// A button of a icon, with a text that explains it; `on`: it is the chosen one. Reported by `name`.
bool icon_button(Context& context, const char* name, const char* icon, const char* tooltip, bool on = false,
                 bool enabled = true);

}  // namespace neuvv::viewer
