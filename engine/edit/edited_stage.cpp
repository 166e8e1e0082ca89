#include "edit/edited_stage.h"

#include <fmt/format.h>

#include <set>

#include "base/file_lock.h"
#include "base/platform.h"
#include "edit/paint_layers.h"
#include "stage/stage.h"
#include "voctree/nvpaint.h"

namespace neuvv::edit {

namespace {

bool is_saved(const Document& document, const PaintLayers::value_type& layer) {
    const auto saved = document.saved_paint.find(layer.first);
    return saved != document.saved_paint.end() && saved->second == layer.second;
}

// The bytes of the file at `path` where another program has written it since the document was read; else nullopt.
std::optional<std::vector<uint8_t>> theirs_at(const Document& document, const std::filesystem::path& path) {
    const stage::StageFile& file = document.file;
    std::error_code ignored;
    const bool same_file = file.saved->on_disk && stage::absolute_path(path) == stage::absolute_path(file.path);
    if (!same_file || !std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
    std::vector<uint8_t> bytes = read_file(path, stage::kMaxStageBytes);
    if (bytes == file.saved->bytes && !document.disk_is_foreign) return std::nullopt;
    return bytes;
}

}  // namespace

bool same_document(const Document& a, const Document& b) {
    return a.file.json == b.file.json && a.paint == b.paint;
}

std::filesystem::path paint_path(const stage::StageFile& file, const std::string& uri) {
    return stage::absolute_path(stage::file_of_uri(file, uri, "paint"));
}

std::shared_ptr<const voctree::EditLayer> open_paint(Document& document, const std::filesystem::path& path,
                                                     const voctree::PaintedField& field) {
    const auto found = document.paint.find(path);
    if (found != document.paint.end()) return found->second;
    auto layer = std::make_shared<const voctree::EditLayer>(voctree::read_paint(path, field));
    document.paint[path] = document.saved_paint[path] = layer;
    return layer;
}

std::optional<std::filesystem::path> save_document(Document& document, const std::filesystem::path& path) {
    stage::expect_sound_document(document.file);
    const std::set<std::filesystem::path> used = used_layers(document.file);
    for (const auto& layer : document.paint) {
        const bool is_in_folder = used.contains(layer.first.parent_path());
        if (!(is_in_folder || used.contains(layer.first)) || is_saved(document, layer)) continue;
        (is_in_folder ? voctree::write_segment_paint : voctree::write_paint)(layer.first, *layer.second);
        document.saved_paint[layer.first] = layer.second;
    }
    std::optional<std::filesystem::path> kept;
    const EditLock lock(path);
    if (const auto theirs = theirs_at(document, path)) {
        kept = free_path(path.parent_path() / (path.stem().string() + "-theirs" + path.extension().string()));
        write_file_atomically(*kept, [&](const ByteSink& sink) { sink(theirs->data(), theirs->size()); });
    }
    stage::save_stage_file(document.file, path);
    document.disk_is_foreign = false;
    return kept;
}

std::filesystem::path free_path(const std::filesystem::path& preferred) {
    std::filesystem::path path = preferred;
    for (int number = 2; std::filesystem::exists(path); number++)
        path = preferred.parent_path() /
               fmt::format("{}-{}{}", preferred.stem().string(), number, preferred.extension().string());
    return path;
}

std::string saved_text(const std::filesystem::path& path, const std::optional<std::filesystem::path>& theirs) {
    const std::string saved = fmt::format("saved {}", path.string());
    if (!theirs) return saved;
    return fmt::format("{}; another program had changed it: its version is kept as {}", saved,
                       theirs->filename().string());
}

}  // namespace neuvv::edit
