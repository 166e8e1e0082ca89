#include "edit/paint_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "edit/document.h"
#include "edit/operations.h"

namespace neuvv::edit {

std::optional<std::vector<ListedLayer>> paint_layers_of(const stage::StageFile& file, uint32_t node) {
    const ordered_json* performer =
        node < node_count(file) ? find_extension(node_of(file, node), stage::kPerformerExtension) : nullptr;
    if (!performer) return std::nullopt;
    std::vector<ListedLayer> layers;
    const ordered_json* list = find_member(*performer, "paint");
    if (!list) return layers;
    for (const ordered_json& layer : *list) {
        stage::PaintLayer entry = stage::paint_layer_of(layer, file.path.string(), fmt::format("/nodes/{}", node));
        layers.push_back({paint_path(file, entry.uri), std::move(entry)});
    }
    return layers;
}

std::string title_of(const ListedLayer& layer) {
    return layer.entry.name.empty() ? layer.path.stem().string() : layer.entry.name;
}

std::filesystem::path free_paint_path(const Document& document, uint32_t node) {
    const std::set<std::filesystem::path> taken = used_layers(document.file);
    std::string stem = node_title(document.file, node);
    for (char& letter : stem)
        if (!std::isalnum(static_cast<unsigned char>(letter)) && static_cast<unsigned char>(letter) < 0x80)
            letter = '-';
    const std::filesystem::path folder = stage::absolute_path(document.file.path).parent_path();
    for (uint32_t number = 1;; ++number) {
        const std::string name = number == 1 ? stem + ".nvpaint" : fmt::format("{}-{}.nvpaint", stem, number);
        const std::filesystem::path path = paint_path(document.file, stage::uri_of_file(document.file, folder / name));
        std::error_code error;
        if (!taken.contains(path) && voctree::files_of_layer(document.paint, path).empty() &&
            !std::filesystem::exists(path, error))
            return path;
    }
}

std::set<std::filesystem::path> used_layers(const stage::StageFile& file) {
    std::set<std::filesystem::path> used;
    for (uint32_t node = 0; node < node_count(file); ++node)
        for (const ListedLayer& layer : paint_layers_of(file, node).value_or(std::vector<ListedLayer>{}))
            used.insert(layer.path);
    return used;
}

bool is_shared(const stage::StageFile& file, uint32_t node, const std::filesystem::path& path) {
    for (uint32_t other = 0; other < node_count(file); ++other) {
        if (other == node) continue;
        const auto used = paint_layers_of(file, other).value_or(std::vector<ListedLayer>{});
        if (std::any_of(used.begin(), used.end(), [&](const ListedLayer& one) { return one.path == path; }))
            return true;
    }
    return false;
}

std::string unshare_paint(Document& document, uint32_t node, size_t at, const std::filesystem::path& new_path,
                          std::shared_ptr<const voctree::EditLayer> layer) {
    const std::vector<ListedLayer> used = paint_layers_of(document.file, node).value();
    const stage::PaintLayer& entry = used.at(at).entry;
    PaintEdit change{title_of(used[at]), entry.visible, entry.opacity, entry.blend};
    add_paint_layer(document.file, node, new_path, change);
    move_paint_layer(document.file, node, used.size(), at);
    remove_paint_layer(document.file, node, at + 1);
    document.paint[new_path] = std::move(layer);
    return fmt::format("{}: \"{}\" is its own now, others keep theirs", node_title(document.file, node),
                       title_of(used[at]));
}

std::string set_paint(Document& document, uint32_t node, const std::filesystem::path& path, const std::string& name,
                      const PaintLayers& files, const std::string& what) {
    const auto used = paint_layers_of(document.file, node).value_or(std::vector<ListedLayer>{});
    if (std::none_of(used.begin(), used.end(), [&](const ListedLayer& one) { return one.path == path; })) {
        PaintEdit entry;
        entry.name = name;
        add_paint_layer(document.file, node, path, entry);
    }
    for (const auto& [file, layer] : files) document.paint[file] = layer;
    return fmt::format("{}: {}", node_title(document.file, node), what);
}

}  // namespace neuvv::edit
