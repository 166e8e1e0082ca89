#include "edit/edited_stage.h"

#include <set>

#include "edit/document.h"
#include "stage/performer_settings.h"
#include "stage/stage.h"
#include "voctree/nvpaint.h"

namespace neuvv {

namespace {

// Of a sound document.
std::set<std::filesystem::path> worn_paint(StageFile& file) {
    std::set<std::filesystem::path> paths;
    if (!file.json.contains("nodes")) return paths;
    for (ordered_json& node : file.json["nodes"]) {
        const ordered_json* performer = find_extension(node, kPerformerExtension);
        if (!performer) continue;
        for (const ordered_json& layer : performer->value("paint", ordered_json::array()))
            paths.insert(paint_path(file, layer["uri"].get<std::string>()));
    }
    return paths;
}

bool is_saved(const Document& document, const PaintLayers::value_type& layer) {
    const auto saved = document.saved_paint.find(layer.first);
    return saved != document.saved_paint.end() && saved->second == layer.second;
}

}  // namespace

std::filesystem::path paint_path(const StageFile& file, const std::string& uri) {
    return absolute_path(file_of_uri(file, uri, "paint"));
}

std::shared_ptr<const EditLayer> open_paint(Document& document, const std::filesystem::path& path,
                                            const PaintedField& field) {
    const auto found = document.paint.find(path);
    if (found != document.paint.end()) return found->second;
    auto layer = std::make_shared<const EditLayer>(read_paint(path, field));
    document.paint[path] = document.saved_paint[path] = layer;
    return layer;
}

void save_document(Document& document, const std::filesystem::path& path) {
    expect_sound_document(document.file);
    const std::set<std::filesystem::path> worn = worn_paint(document.file);
    for (const auto& layer : document.paint) {
        if (!worn.contains(layer.first) || is_saved(document, layer)) continue;
        write_paint(layer.first, *layer.second);
        document.saved_paint[layer.first] = layer.second;
    }
    save_stage_file(document.file, path);
}

}  // namespace neuvv
