// Where the panel's items are after a script, found without the program: by its interaction and its panel alone.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace neuvv::test {

// The middles of the panel's items (tracking space), by name, at a frame of a script (tests/xr_runtime/README.md) for
// the stage in a file, with the user's settings from another file. Empty while the panel is hidden. Controllers have
// the buttons of a Meta Touch, and the tracking space does not change.
nlohmann::json panel_items_after(const nlohmann::json& script, int end_frame, const std::filesystem::path& stage,
                                 const std::filesystem::path& settings);

}  // namespace neuvv::test
