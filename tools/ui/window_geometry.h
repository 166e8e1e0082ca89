// Where a window is on the screen, and how large.
#pragma once

#include <optional>
#include <utility>

namespace neuvv::ui {

struct WindowGeometry {
    int width = 1600, height = 900;         // 320 to 16384
    std::optional<std::pair<int, int>> at;  // the left upper corner, −32768 to 32767; nothing: where the system likes
    bool maximised = false;
};

}  // namespace neuvv::ui
