#include "tools/viewer/view_state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tools/viewer/preferences.h"

namespace neuvv::viewer {

namespace {

// What the view menu shows and hides, by the names under which preferences keep it.
template <typename View>
auto switches(View& view) {
    return std::array{std::pair("grid", &view.grid), std::pair("axes", &view.axes),
                      std::pair("statistics", &view.panels.statistics),
                      std::pair("pass times", &view.panels.pass_times)};
}

}  // namespace

void apply_preferences(ViewState& view, const Preferences& preferences) {
    const PreviewQuality& preview = preferences.preview;
    view.image.max_scale = static_cast<float>(preview.resolution);
    view.image.samples = std::clamp(static_cast<int>(std::lround(std::sqrt(preview.samples))), 1, 4);
    view.image.far_levels = preview.far_levels;
    const std::map<std::string, PanelSize>& panels = preferences.panels;
    if (const auto side = panels.find("side"); side != panels.end()) {
        view.panels.all = side->second.open;
        view.panels.side_width = static_cast<float>(side->second.width);
    }
    for (const auto& [name, on] : switches(view))
        if (const auto kept = panels.find(name); kept != panels.end()) *on = kept->second.open;
    for (size_t i = 0; i < std::size(kLayerNames); ++i)
        if (preferences.layer == kLayerNames[i]) view.image.show = static_cast<render::Show>(i);
}

void note_preferences(const ViewState& view, Preferences& preferences) {
    const ImageSettings& image = view.image;
    preferences.preview = {image.max_scale, static_cast<uint32_t>(image.samples * image.samples), image.far_levels};
    preferences.layer = kLayerNames[static_cast<size_t>(image.show)];
    preferences.panels["side"] = {view.panels.all, view.panels.side_width};
    for (const auto& [name, on] : switches(view)) preferences.panels[name].open = *on;
}

}  // namespace neuvv::viewer
