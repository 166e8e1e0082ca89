#include "edit/recovery.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <tuple>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/platform.h"
#include "stage/file/json_splice.h"
#include "stage/stage.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::edit {

namespace {

using nlohmann::ordered_json;

constexpr const char* kEntryName = "entry.json";
constexpr const char* kLockName = "lock";
constexpr uint64_t kMaxEntryBytes = 3 * stage::kMaxStageJsonBytes;
constexpr uint64_t kVersion = 1;

// A path as ASCII text, as paths are bytes but JSON is UTF-8. decoded_uri reads it.
std::string escaped(const std::filesystem::path& path) {
    std::string text;
    for (const char c : path.string())
        if (c < ' ' || c > '~' || c == '%')
            text += fmt::format("%{:02X}", static_cast<unsigned char>(c));
        else
            text += c;
    return text;
}

std::string hex(uint64_t number) {
    return fmt::format("{:016x}", number);
}

// The JSON as text. Never fails: a name that is no UTF-8 must not lose the rest.
std::string indented_text(const ordered_json& json, int indent) {
    return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

uint64_t hash_of(const std::vector<uint8_t>& bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

uint64_t hash_of(const voctree::EditLayer& layer) {
    static_assert(sizeof(voctree::LeafEdit) == 8 * sizeof(float), "no bytes between the members");
    return XXH3_64bits(layer.edits.data(), layer.edits.size() * sizeof(voctree::LeafEdit));
}

// Every value of an entry is checked when it is read.
constexpr JsonDamage kDamaged{"is missing or damaged", "discard what cannot be recovered"};

OrderedJsonNode entry_node(const ordered_json& json, const std::string& file) {
    return {json, file, "", JsonPlaceStyle::kDotted, &kDamaged};
}

uint64_t hex_of(const OrderedJsonNode& node) {
    const std::string& digits = json_string(node);
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (error != std::errc() || end != digits.data() + digits.size()) node.fail("is no hexadecimal number");
    return value;
}

std::filesystem::path path_of(const OrderedJsonNode& node) {
    const std::string decoded = stage::decoded_uri(json_string(node));
    const std::filesystem::path found(decoded);
    if (!found.is_absolute() || decoded.find('\0') != std::string::npos) node.fail("is no absolute path");
    return found;
}

ordered_json read_entry(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / kEntryName;
    const std::vector<uint8_t> bytes = read_file(file, kMaxEntryBytes);
    ordered_json json = stage::parse_document(
        std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), file.string());
    const std::string name = file.string();
    if (json_count(entry_node(json, name)["version"], UINT64_MAX) != kVersion)
        throw InputError(file.string(), "version", "is another program's", "recover it with the neuvv that wrote it");
    return json;
}

bool is_changed(const RecoveryEntry& entry, uint64_t disk_hash) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(entry.stage, error)) return entry.on_disk;
    return !entry.on_disk || hash_of(read_file(entry.stage, stage::kMaxStageBytes)) != disk_hash;
}

RecoveryEntry entry_of(const std::filesystem::path& folder) {
    const ordered_json json = read_entry(folder);
    const std::string file = (folder / kEntryName).string();
    const OrderedJsonNode node = entry_node(json, file);
    RecoveryEntry entry;
    entry.folder = folder;
    entry.stage = path_of(node["stage"]);
    entry.when_s = static_cast<int64_t>(json_count(node["when"], INT64_MAX));
    entry.process = static_cast<int64_t>(json_count(node["process"], INT64_MAX));
    entry.on_disk = json_flag(node["on_disk"]);
    entry.alive = is_file_locked(folder / kLockName);
    entry.changed = is_changed(entry, hex_of(node["disk_hash"]));
    return entry;
}

int64_t now_s() {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::seconds>(since).count();
}

void restore_layer(Document& document, const ordered_json& json, const RecoveryEntry& entry) {
    const std::string file = (entry.folder / kEntryName).string();
    const OrderedJsonNode node = entry_node(json, file);
    const std::filesystem::path name = json_string(node["file"]);
    if (!name.has_filename() || name.filename() != name || name == ".." || name == ".")
        node["file"].fail("is no name of a file");
    const voctree::PaintedField field{hex_of(node["topology"]),
                                      static_cast<uint32_t>(json_count(node["leaves"], UINT32_MAX)),
                                      static_cast<uint32_t>(json_count(node["frames"], UINT32_MAX))};
    const std::filesystem::path path = path_of(node["path"]);
    document.paint[path] = std::make_shared<const voctree::EditLayer>(voctree::read_paint(entry.folder / name, field));
    std::error_code error;
    if (!node.value.contains("saved") || !std::filesystem::exists(path, error)) return;
    const uint64_t saved = hex_of(node["saved"]);
    try {
        auto disk = std::make_shared<const voctree::EditLayer>(voctree::read_paint(path, field));
        if (hash_of(*disk) == saved) document.saved_paint[path] = std::move(disk);
    } catch (const InputError&) {  // saving keeps what is there
    }
}

}  // namespace

// Makes a new folder for the entry. Existing folders are not reused: an earlier process with the same id may have left
// one.
void RecoveryWriter::make_entry() {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    for (uint32_t n = 0; entry_.empty(); ++n) {
        const std::filesystem::path entry = folder_ / fmt::format("{}-{}", process_id(), n);
        if (std::filesystem::create_directory(entry, error))
            entry_ = entry;
        else if (error)
            throw RuntimeFailure(fmt::format("{}: cannot be made: {}", entry.string(), error.message()));
    }
    lock_ = FileLock(entry_ / kLockName);
}

RecoveryWriter::StoredLayers RecoveryWriter::store_layers(const Document& document) {
    StoredLayers stored;
    for (const auto& [path, layer] : document.paint) {
        const auto found = document.saved_paint.find(path);
        const auto saved = found == document.saved_paint.end() ? nullptr : found->second;
        if (saved == layer) continue;
        const auto before = layers_.find(path);
        if (before != layers_.end() && before->second.layer == layer) {
            stored[path] = {layer, saved, before->second.file};
            continue;
        }
        const std::string name = fmt::format("{}.nvpaint", next_layer_++);
        voctree::write_paint(entry_ / name, *layer);
        stored[path] = {layer, saved, name};
    }
    return stored;
}

void RecoveryWriter::remove_layers_but(const StoredLayers& kept) {
    for (const auto& [path, stored] : layers_) {
        const auto found = kept.find(path);
        std::error_code ignored;
        if (found == kept.end() || found->second.file != stored.file)
            std::filesystem::remove(entry_ / stored.file, ignored);
    }
}

std::filesystem::path recovery_folder() {
    const std::filesystem::path folder = state_folder();
    return folder.empty() ? folder : folder / "recovery";
}

void RecoveryWriter::store(const Document& document) {
    if (entry_.empty()) make_entry();
    StoredLayers layers = store_layers(document);
    const bool same_disk = file_.saved == document.file.saved;
    if (same_disk && file_.path == document.file.path && layers == layers_ && file_.json == document.file.json) return;
    const uint64_t hash = document.disk_is_foreign ? 0 : same_disk ? disk_hash_ : hash_of(document.file.saved->bytes);
    ordered_json json = {{"version", kVersion},
                         {"stage", escaped(stage::absolute_path(document.file.path))},
                         {"when", static_cast<uint64_t>(now_s())},
                         {"process", static_cast<uint64_t>(process_id())},
                         {"on_disk", document.file.saved->on_disk},
                         {"disk_hash", hex(hash)},
                         {"paint", ordered_json::array()}};
    for (const auto& [path, stored] : layers) {
        json["paint"].push_back({{"path", escaped(path)},
                                 {"file", stored.file},
                                 {"topology", hex(stored.layer->field.topology)},
                                 {"leaves", stored.layer->field.leaf_count},
                                 {"frames", stored.layer->field.frames}});
        if (stored.saved) json["paint"].back()["saved"] = hex(hash_of(*stored.saved));
    }
    json["document"] = document.file.json.text();
    const std::string text = indented_text(json, 1);
    write_file_atomically(entry_ / kEntryName, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
    remove_layers_but(layers);
    layers_ = std::move(layers);
    file_ = document.file;
    disk_hash_ = hash;
}

void RecoveryWriter::discard() {
    std::error_code ignored;
    if (!entry_.empty()) std::filesystem::remove_all(entry_, ignored);
    *this = RecoveryWriter(folder_);
}

std::vector<RecoveryEntry> list_recovery(const std::filesystem::path& folder) {
    std::vector<RecoveryEntry> entries;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        std::error_code ignored;
        if (!std::filesystem::is_directory(at->symlink_status(ignored))) continue;
        try {
            entries.push_back(entry_of(at->path()));
        } catch (const InputError&) {
            // A damaged entry must not hide the others.
        }
    }
    std::sort(entries.begin(), entries.end(), [](const RecoveryEntry& a, const RecoveryEntry& b) {
        return std::tie(b.when_s, a.folder) < std::tie(a.when_s, b.folder);
    });
    return entries;
}

std::vector<RecoveryEntry> find_recovery(const std::filesystem::path& folder, const std::filesystem::path& stage) {
    std::vector<RecoveryEntry> entries = list_recovery(folder);
    std::erase_if(entries,
                  [whole = stage::absolute_path(stage)](const RecoveryEntry& entry) { return entry.stage != whole; });
    return entries;
}

bool has_foreign_file(const RecoveryEntry& entry) {
    std::error_code error;
    return entry.changed && entry.on_disk && std::filesystem::exists(entry.stage, error);
}

Document restore(const RecoveryEntry& entry) {
    const ordered_json json = read_entry(entry.folder);
    const std::string file = (entry.folder / kEntryName).string();
    const OrderedJsonNode node = entry_node(json, file);
    ordered_json stored = stage::parse_document(json_string(node["document"]), file);
    const std::filesystem::path stage = path_of(node["stage"]);
    std::error_code error;
    const bool on_disk = json_flag(node["on_disk"]);
    Document document;
    // A .gltf is all in its text; the buffers of a .glb are beside its JSON in the file.
    if (on_disk && (stage.extension() != ".gltf" || std::filesystem::exists(stage, error))) {
        document.file = stage::read_stage_file(stage);
        document.disk_is_foreign = has_foreign_file(entry);
    } else {
        document.file = stage::make_stage_file(stage, indented_text(stored, 2) + "\n");
    }
    document.file.json = stage::StageJson(std::move(stored));
    document.file.json.share(document.file.saved->json);
    stage::expect_sound_document(document.file);
    const OrderedJsonNode paint = node["paint"];
    if (!paint.value.is_array()) paint.fail_type("an array");
    for (const ordered_json& layer : paint.value) restore_layer(document, layer, entry);
    return document;
}

void discard(const RecoveryEntry& entry) {
    std::error_code ignored;
    std::filesystem::remove_all(entry.folder, ignored);
}

}  // namespace neuvv::edit
