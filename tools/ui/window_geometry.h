// Position and size of a window on the screen.
#pragma once

#include <optional>
#include <utility>

namespace neuvv::ui {

struct WindowGeometry {
    int width = 1600, height = 900;         // 320 to 16384
    std::optional<std::pair<int, int>> at;  // the upper left corner, −32768 to 32767; nothing: the system chooses
    bool maximised = false;
};

}  // namespace neuvv::ui
