#include "tools/viewer/layer_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>

#include "edit/operations.h"

namespace neuvv::viewer {

namespace {

const nlohmann::ordered_json* node_of(const stage::StageFile& file, uint32_t node) {
    const auto nodes = file.json.find("nodes");
    return nodes != file.json.end() && node < nodes->size() ? &(*nodes)[node] : nullptr;
}

std::string node_name(const stage::StageFile& file, uint32_t node) {
    const nlohmann::ordered_json* json = node_of(file, node);
    const std::string name = json ? json->value("name", "") : "";
    return name.empty() ? fmt::format("node {}", node) : name;
}

}  // namespace

std::optional<std::vector<ListedLayer>> layers_of(const stage::StageFile& file, uint32_t node) {
    const nlohmann::ordered_json* json = node_of(file, node);
    if (!json || !json->contains("extensions") || !(*json)["extensions"].contains(stage::kPerformerExtension))
        return {};
    const nlohmann::ordered_json& performer = (*json)["extensions"][stage::kPerformerExtension];
    std::vector<ListedLayer> layers;
    const auto list = performer.find("paint");
    if (list == performer.end()) return layers;
    for (const nlohmann::ordered_json& layer : *list) {
        stage::PaintLayer entry = stage::paint_layer_of(layer, file.path.string(), fmt::format("/nodes/{}", node));
        layers.push_back({edit::paint_path(file, entry.uri), std::move(entry)});
    }
    return layers;
}

std::string title_of(const ListedLayer& layer) {
    return layer.entry.name.empty() ? layer.path.stem().string() : layer.entry.name;
}

std::filesystem::path free_paint_path(const edit::Document& document, uint32_t node) {
    const std::set<std::filesystem::path> taken = worn_layers(document.file);
    std::string stem = node_name(document.file, node);
    for (char& letter : stem)
        if (!std::isalnum(static_cast<unsigned char>(letter)) && static_cast<unsigned char>(letter) < 0x80)
            letter = '-';
    const std::filesystem::path folder = stage::absolute_path(document.file.path).parent_path();
    for (uint32_t number = 1;; number++) {
        const std::string name = number == 1 ? stem + ".nvpaint" : fmt::format("{}-{}.nvpaint", stem, number);
        const std::filesystem::path path =
            edit::paint_path(document.file, stage::uri_of_file(document.file, folder / name));
        std::error_code error;
        if (!taken.contains(path) && !document.paint.contains(path) && !std::filesystem::exists(path, error))
            return path;
    }
}

std::set<std::filesystem::path> worn_layers(const stage::StageFile& file) {
    std::set<std::filesystem::path> worn;
    const auto nodes = file.json.find("nodes");
    const size_t count = nodes != file.json.end() ? nodes->size() : 0;
    for (uint32_t node = 0; node < count; node++)
        for (const ListedLayer& layer : layers_of(file, node).value_or(std::vector<ListedLayer>{}))
            worn.insert(layer.path);
    return worn;
}

bool is_shared(const stage::StageFile& file, uint32_t node, const std::filesystem::path& path) {
    const auto nodes = file.json.find("nodes");
    const size_t count = nodes != file.json.end() ? nodes->size() : 0;
    for (uint32_t other = 0; other < count; other++) {
        if (other == node) continue;
        const auto worn = layers_of(file, other).value_or(std::vector<ListedLayer>{});
        if (std::any_of(worn.begin(), worn.end(), [&](const ListedLayer& one) { return one.path == path; }))
            return true;
    }
    return false;
}

std::string own_paint(edit::Document& document, uint32_t node, size_t at, const std::filesystem::path& own,
                      std::shared_ptr<const voctree::EditLayer> layer) {
    const std::vector<ListedLayer> worn = layers_of(document.file, node).value();
    const stage::PaintLayer& entry = worn.at(at).entry;
    edit::PaintEdit edit{title_of(worn[at]), entry.visible, entry.opacity, entry.blend};
    edit::add_paint_layer(document.file, node, own, edit);
    edit::move_paint_layer(document.file, node, worn.size(), at);
    edit::remove_paint_layer(document.file, node, at + 1);
    document.paint[own] = std::move(layer);
    return fmt::format("{}: \"{}\" is its own now, others keep theirs", node_name(document.file, node),
                       title_of(worn[at]));
}

std::string put_paint(edit::Document& document, uint32_t node, const std::filesystem::path& path,
                      const std::string& name, std::shared_ptr<const voctree::EditLayer> layer,
                      const std::string& what) {
    const auto worn = layers_of(document.file, node).value_or(std::vector<ListedLayer>{});
    if (std::none_of(worn.begin(), worn.end(), [&](const ListedLayer& one) { return one.path == path; })) {
        edit::PaintEdit entry;
        entry.name = name;
        edit::add_paint_layer(document.file, node, path, entry);
    }
    document.paint[path] = std::move(layer);
    return fmt::format("{}: {}", node_name(document.file, node), what);
}

}  // namespace neuvv::viewer
