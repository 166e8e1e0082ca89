#include "stage/file/stage_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/platform.h"
#include "base/text.h"
#include "stage/file/gltf_container.h"
#include "stage/file/json_splice.h"
#include "stream/transport/byte_source.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

std::string_view json_text(const StageFile::Saved& saved) {
    return std::string_view(reinterpret_cast<const char*>(saved.bytes.data()), saved.bytes.size())
        .substr(saved.json_begin, saved.json_size);
}

// Reads the file's JSON from its bytes. Members that are equal to those of `known` are shared with it.
std::shared_ptr<const StageFile::Saved> saved_of(std::vector<uint8_t> bytes, const std::string& file,
                                                 bool on_disk = true, const StageJson& known = {}) {
    const auto saved = std::make_shared<StageFile::Saved>();
    saved->on_disk = on_disk;
    const GltfContainer container = find_gltf_json(bytes, file);
    saved->bytes = std::move(bytes);
    saved->binary = container.binary;
    saved->json_begin = container.json_begin;
    saved->json_size = container.json_size;
    if (saved->json_size > kMaxStageJsonBytes)
        throw InputError(
            file, "",
            fmt::format("has {} bytes of JSON, more than the {} of a stage", saved->json_size, kMaxStageJsonBytes));
    ordered_json json = parse_document(json_text(*saved), file);
    if (!json.is_object()) throw InputError(file, "", "is neither a .glb nor a JSON object", "give a glTF 2.0 file");
    saved->json = StageJson(std::move(json));
    saved->json.share(known);
    return saved;
}

bool is_named_binary(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending == ".glb";
}

// Calls edit(uri, place, below) for every URI in `value`, the document's member of this name, that names a file.
// `below` says that the file must be below the stage's folder.
template <typename Edit>
void edit_uris(ordered_json& value, const std::string& member, const Edit& edit) {
    const auto edit_uri = [&](ordered_json& owner, const std::string& place, bool below) {
        if (!owner.is_object() || !owner.contains("uri") || !owner["uri"].is_string()) return;
        const auto& uri = owner["uri"].get_ref<const std::string&>();
        if (!uri.starts_with("data:") && !stream::is_address(uri)) edit(owner["uri"], place + "/uri", below);
    };
    const auto each_of = [](ordered_json& list, const std::string& name, const auto& each) {
        if (!list.is_array()) return;
        for (size_t i = 0; i < list.size(); ++i) each(list[i], fmt::format("/{}/{}", name, i));
    };
    const auto extension = [](ordered_json& owner, const char* name) -> ordered_json* {
        if (!owner.is_object() || !owner.contains("extensions")) return nullptr;
        ordered_json& extensions = owner["extensions"];
        return extensions.is_object() && extensions.contains(name) ? &extensions[name] : nullptr;
    };
    each_of(value, member, [&](ordered_json& owner, const std::string& place) {
        if (member == "buffers" || member == "images") return edit_uri(owner, place, true);
        if (ordered_json* performer = extension(owner, "NEUVV_performer"); performer && member == "nodes") {
            edit_uri(*performer, place + "/extensions/NEUVV_performer", false);
            for (const char* named : {"skeleton", "sound"})
                if (performer->is_object() && performer->contains(named))
                    edit_uri((*performer)[named], place + "/extensions/NEUVV_performer/" + named, false);
            if (performer->is_object() && performer->contains("paint"))
                each_of((*performer)["paint"], "paint",
                        [&](ordered_json& layer, const std::string& at) { edit_uri(layer, place + at, false); });
        }
        if (ordered_json* stage = extension(owner, "NEUVV_stage"); stage && member == "scenes")
            if (stage->is_object() && stage->contains("environment"))
                edit_uri((*stage)["environment"], place + "/extensions/NEUVV_stage/environment", false);
    });
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    return absolute_path(file).parent_path();
}

// The document with its URIs rewritten for the folder of `path`.
StageJson rebased(const StageFile& file, const std::filesystem::path& path) {
    StageJson json = file.json;
    StageFile there{path, {}, {}};
    const auto rebase = [&](ordered_json& uri, const std::string& place, bool below) {
        const std::string moved = uri_of_file(there, file_of_uri(file, uri.get<std::string>(), place));
        if (below && moved.starts_with("../"))
            throw InputError(path.string(), place,
                             fmt::format("\"{}\" would lie outside of the stage's folder", uri.get<std::string>()),
                             "save beside it, or make a .glb of the stage, which holds its buffers and images");
        uri = moved;
    };
    for (const char* member : {"buffers", "images", "nodes", "scenes"})
        if (json.contains(member)) edit_uris(json.edit(member), member, rebase);
    json.share(file.json);  // members in which no URI changed
    return json;
}

void append_word(std::vector<uint8_t>& bytes, size_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(value >> shift));
}

// The bytes of a .glb with this JSON; what follows the JSON chunk in `saved` is kept.
std::vector<uint8_t> glb_of(const std::string& json, const StageFile::Saved* saved) {
    const size_t padded = (json.size() + 3) / 4 * 4;
    // Of the old file: where the JSON chunk ends, the container's length, and the bytes that follow the container.
    uint64_t tail_begin = 0, length = 0, after = 0;
    if (saved) {
        tail_begin = saved->json_begin + saved->json_size;
        length = gltf_word_at(saved->bytes, 8);
        after = saved->bytes.size() - length;
    }
    const uint64_t total = 20 + padded + (length - tail_begin);
    if (total > UINT32_MAX) throw InputError("stage", "", "is too large for a .glb", "save it as a .gltf");
    std::vector<uint8_t> bytes;
    bytes.reserve(total + after);
    append_word(bytes, 0x46546C67);
    append_word(bytes, 2);
    append_word(bytes, total);
    append_word(bytes, padded);
    append_word(bytes, 0x4E4F534A);
    bytes.insert(bytes.end(), json.begin(), json.end());
    bytes.resize(20 + padded, ' ');
    if (saved) bytes.insert(bytes.end(), saved->bytes.begin() + static_cast<ptrdiff_t>(tail_begin), saved->bytes.end());
    return bytes;
}

}  // namespace

// The servers that a stage names are asked as its user would ask them, also those in the own network. So a stage of
// somebody else must have been saved here by the user, not fetched.
StageFile read_stage_file(const std::filesystem::path& path) {
    if (stream::is_address(path))
        throw InputError(without_passwords(path.string()), "", "is on a server, and stages are read from files alone",
                         "download it, if you trust who made it; only streams (.nvs) are played from servers");
    StageFile file;
    file.path = path;
    file.saved = saved_of(read_file(path, kMaxStageBytes), path.string());
    file.json = file.saved->json;
    return file;
}

void expect_unchanged(const StageFile& file) {
    if (read_file(file.path, kMaxStageBytes) != file.saved->bytes)
        throw InputError(file.path.string(), "", "was changed by another program meanwhile", "try again");
}

StageFile make_stage_file(const std::filesystem::path& path, const std::string& json_text) {
    StageFile file;
    file.path = path;
    std::vector<uint8_t> bytes(json_text.begin(), json_text.end());
    file.saved = saved_of(is_named_binary(path) ? glb_of(json_text, nullptr) : std::move(bytes), path.string(), false);
    file.json = file.saved->json;
    return file;
}

std::vector<uint8_t> stage_bytes(const StageFile& file) {
    const StageFile::Saved& saved = *file.saved;
    if (file.json == saved.json) return saved.bytes;
    std::string json;
    try {
        json = spliced(json_text(saved), saved.json, file.json);
    } catch (const nlohmann::json::type_error&) {
        throw InputError(file.path.string(), "", "would hold a name that is not UTF-8, which glTF does not allow",
                         Remedy::kGiveName);
    }
    if (!saved.binary) return {json.begin(), json.end()};
    while (json.ends_with(' ')) json.pop_back();  // the chunk's padding
    return glb_of(json, &saved);
}

StageFile moved_to(StageFile file, const std::filesystem::path& path) {
    if (folder_of(file.path) != folder_of(path)) file.json = rebased(file, path);
    file.path = path;
    return file;
}

void save_stage_file(StageFile& file, const std::filesystem::path& path) {
    if (is_named_binary(path) != file.saved->binary)
        throw InputError(path.string(), "", file.saved->binary ? "this stage is a .glb" : "this stage is a .gltf",
                         "keep the ending");
    StageFile moved = moved_to(file, path);
    std::vector<uint8_t> bytes = stage_bytes(moved);
    auto saved = saved_of(bytes, path.string(), true, moved.json);
    write_file_atomically(path, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
    moved.saved = std::move(saved);
    moved.json = moved.saved->json;
    file = std::move(moved);
}

std::filesystem::path absolute_path(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::path absolute = std::filesystem::absolute(file);
    const std::filesystem::path whole = std::filesystem::weakly_canonical(absolute, error);
    return error ? absolute.lexically_normal() : whole;
}

std::string decoded_uri(const std::string& uri) {
    std::string decoded;
    for (size_t i = 0; i < uri.size(); ++i) {
        unsigned value = 0;
        if (uri[i] == '%' && i + 2 < uri.size() && std::sscanf(uri.c_str() + i + 1, "%2x", &value) == 1) {
            decoded += static_cast<char>(value);
            i += 2;
        } else {
            decoded += uri[i];
        }
    }
    return decoded;
}

std::string encoded_uri(const std::string& path) {
    std::string encoded;
    const bool letters = is_utf8(path);  // other bytes above 0x7f are escaped
    for (const char c : path) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte <= ' ' || (byte >= 0x80 && !letters) || byte == 0x7f || std::strchr("%#?\"<>\\^`{|}:", c))
            encoded += fmt::format("%{:02X}", byte);
        else
            encoded += c;
    }
    return encoded;
}

std::filesystem::path file_of_uri(const StageFile& file, const std::string& uri, const std::string& place) {
    const std::string name = decoded_uri(uri);
    // An escaped colon is part of a name; any other ends a scheme or a drive letter.
    if (uri.empty() || name[0] == '/' || uri.find(':') != std::string::npos || name.find('\\') != std::string::npos ||
        name.find('\0') != std::string::npos)
        throw InputError(file.path.string(), place, fmt::format("\"{}\" is no relative path of a file", uri),
                         "name the file by its path from the stage's folder, as in ../captures/anna.nvv");
    return file.path.parent_path() / name;
}

std::string uri_of_file(const StageFile& file, const std::filesystem::path& named) {
    const std::filesystem::path whole = folder_of(named) / named.filename();
    return encoded_uri(whole.lexically_relative(folder_of(file.path)).generic_string());
}

std::filesystem::path file_or_address_of_uri(const StageFile& file, const std::string& uri, const std::string& place) {
    return stream::is_address(uri) ? std::filesystem::path(uri) : absolute_path(file_of_uri(file, uri, place));
}

std::string uri_of_file_or_address(const StageFile& file, const std::filesystem::path& named) {
    return stream::is_address(named) ? named.string() : uri_of_file(file, named);
}

}  // namespace neuvv::stage
