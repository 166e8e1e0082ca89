#include "edit/edited_stage.h"

#include <fmt/format.h>

#include <set>

#include "base/error.h"
#include "base/file_lock.h"
#include "base/platform.h"
#include "edit/paint_layers.h"
#include "stage/stage.h"
#include "voctree/files/nvpaint.h"

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

// Whether the file of a layer has other paint than it had when it was read, and than the layer has now.
bool is_foreign(const Document& document, const PaintLayers::value_type& layer) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(layer.first, ignored)) return false;
    const auto saved = document.saved_paint.find(layer.first);
    try {
        const std::vector<voctree::LeafEdit> now = voctree::read_paint(layer.first, layer.second->field).edits;
        return now != layer.second->edits && (saved == document.saved_paint.end() || now != saved->second->edits);
    } catch (const InputError&) {
        return true;  // it is of another clip, or damaged
    }
}

std::filesystem::path theirs_path(const std::filesystem::path& of) {
    return free_path(of.parent_path() / (of.stem().string() + "-theirs" + of.extension().string()));
}

void copy_atomically(const std::filesystem::path& from, const std::filesystem::path& to) {
    const std::vector<uint8_t> bytes = read_file(from);
    write_file_atomically(to, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

// Of a layer at the path `of`, of which `file` is a segment where they differ.
void keep_theirs(const std::filesystem::path& of, const std::filesystem::path& file, std::vector<KeptVersion>& kept) {
    if (kept.empty() || kept.back().of != of) kept.push_back({of, theirs_path(of)});  // segments follow each other
    const std::filesystem::path& as = kept.back().as;
    if (file == of) return copy_atomically(file, as);
    std::filesystem::create_directories(as);
    copy_atomically(file, as / file.filename());
}

// The lock, once nobody else has it.
std::unique_ptr<EditLock> lock_for_save(const std::filesystem::path& file, const WaitsOn& waits_on) {
    struct StillHeld {};
    if (!waits_on) return std::make_unique<EditLock>(file);
    for (;;) {
        try {
            return std::make_unique<EditLock>(file, [] { throw StillHeld(); });
        } catch (const StillHeld&) {
            if (!waits_on(file))
                throw RuntimeFailure(
                    fmt::format("{}: not saved, as another program is editing it; save again", file.string()));
        }
    }
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

std::vector<KeptVersion> save_document(Document& document, const std::filesystem::path& path, const WaitsOn& waits_on) {
    stage::expect_sound_document(document.file);
    const std::set<std::filesystem::path> used = used_layers(document.file);
    std::vector<KeptVersion> kept;
    for (const auto& layer : document.paint) {
        const bool is_in_folder = used.contains(layer.first.parent_path());
        if (!(is_in_folder || used.contains(layer.first)) || is_saved(document, layer)) continue;
        const std::filesystem::path of = is_in_folder ? layer.first.parent_path() : layer.first;
        const auto lock = lock_for_save(of, waits_on);
        if (is_foreign(document, layer)) keep_theirs(of, layer.first, kept);
        (is_in_folder ? voctree::write_segment_paint : voctree::write_paint)(layer.first, *layer.second);
        document.saved_paint[layer.first] = layer.second;
    }
    const auto lock = lock_for_save(path, waits_on);
    if (const auto theirs = theirs_at(document, path)) {
        kept.push_back({path, theirs_path(path)});
        write_file_atomically(kept.back().as, [&](const ByteSink& sink) { sink(theirs->data(), theirs->size()); });
    }
    stage::save_stage_file(document.file, path);
    document.disk_is_foreign = false;
    return kept;
}

std::filesystem::path free_path(const std::filesystem::path& preferred) {
    std::filesystem::path path = preferred;
    for (int number = 2; std::filesystem::exists(path); ++number)
        path = preferred.parent_path() /
               fmt::format("{}-{}{}", preferred.stem().string(), number, preferred.extension().string());
    return path;
}

std::string saved_text(const std::filesystem::path& path, const std::vector<KeptVersion>& kept) {
    std::string text = fmt::format("saved {}", path.string());
    for (const KeptVersion& one : kept)
        text += fmt::format("; another program had changed {}: its version is kept as {}",
                            one.of == path ? "it" : one.of.filename().string(), one.as.filename().string());
    return text;
}

}  // namespace neuvv::edit
