// The list of a performer's paint layers; the paint itself is in the files of the layers.
#include <fmt/format.h>

#include "base/error.h"
#include "edit/document.h"
#include "edit/operations.h"

namespace neuvv::edit {

namespace {

ordered_json& layer_of(stage::StageFile& file, uint32_t node, size_t layer) {
    ordered_json& performer = performer_of(file, node);
    const size_t count = performer.contains("paint") ? performer["paint"].size() : 0;
    if (layer >= count)
        throw InputError(file.path.string(), fmt::format("/nodes/{}", node),
                         fmt::format("{} has no paint layer {}", title_of(file, node), layer),
                         count == 0 ? "it has none" : fmt::format("choose from 0 to {}", count - 1));
    return performer["paint"][layer];
}

void edit_layer(ordered_json& layer, const PaintEdit& edit) {
    if (edit.name) layer["name"] = *edit.name;
    if (edit.visible) layer["visible"] = *edit.visible;
    if (edit.opacity) layer["opacity"] = *edit.opacity;
    if (edit.blend) layer["blend"] = stage::kPaintBlendNames[static_cast<size_t>(*edit.blend)];
}

// A layer in a message: "0 \"red\" (red.nvpaint): tint, opacity 0.5".
std::string summary_of(size_t index, const ordered_json& layer) {
    const std::string name = layer.value("name", "");
    return fmt::format("{} {}({}): {}, opacity {:.6g}{}", index, name.empty() ? "" : fmt::format("\"{}\" ", name),
                       layer["uri"].get<std::string>(), layer.value("blend", "normal"), layer.value("opacity", 1.0),
                       layer.value("visible", true) ? "" : ", not seen");
}

}  // namespace

std::string add_paint_layer(stage::StageFile& file, uint32_t node, const std::filesystem::path& paint,
                            const PaintEdit& edit) {
    ordered_json& layers = list_in(performer_of(file, node), "paint");
    ordered_json layer = {{"uri", stage::uri_of_file(file, paint)}};
    edit_layer(layer, edit);
    layers.push_back(layer);
    return fmt::format("{}: paint layer {}", title_of(file, node), summary_of(layers.size() - 1, layer));
}

std::string set_paint_layer(stage::StageFile& file, uint32_t node, size_t layer, const PaintEdit& edit) {
    ordered_json& json = layer_of(file, node, layer);
    edit_layer(json, edit);
    return fmt::format("{}: paint layer {}", title_of(file, node), summary_of(layer, json));
}

std::string move_paint_layer(stage::StageFile& file, uint32_t node, size_t from, size_t to) {
    layer_of(file, node, to);
    ordered_json moved = layer_of(file, node, from);
    ordered_json& layers = performer_of(file, node)["paint"];
    layers.erase(from);
    layers.insert(layers.begin() + static_cast<std::ptrdiff_t>(to), std::move(moved));
    return fmt::format("{}: paint layer {} is layer {} now", title_of(file, node), from, to);
}

std::string remove_paint_layer(stage::StageFile& file, uint32_t node, size_t layer) {
    layer_of(file, node, layer);
    ordered_json& performer = performer_of(file, node);
    performer["paint"].erase(layer);
    if (performer["paint"].empty()) performer.erase("paint");
    return fmt::format("{}: paint layer {} removed", title_of(file, node), layer);
}

}  // namespace neuvv::edit
