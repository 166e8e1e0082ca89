#include <nlohmann/json.hpp>

#include "stage/gltf/gltf_parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "base/error.h"
#include "base/platform.h"
#include "base/text.h"
#include "stage/file/gltf_container.h"
#include "stage/file/json_splice.h"
#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_check.h"
#include "stage/gltf/gltf_mend.h"
#include "stream/codec/bytes.h"

namespace neuvv::stage {

namespace {

struct Source {
    std::string file;
    std::string folder;
    std::vector<uint8_t> bytes;
    GltfContainer container;
};

constexpr int kWord = 4;  // bytes

void append_chunk(std::vector<uint8_t>& bytes, uint32_t type, std::span<const uint8_t> content, uint8_t padding) {
    const size_t size = (content.size() + 3) / 4 * 4;
    stream::append_number(bytes, size, kWord);
    stream::append_number(bytes, type, kWord);
    bytes.insert(bytes.end(), content.begin(), content.end());
    bytes.insert(bytes.end(), size - content.size(), padding);
}

// Whether tinygltf refuses the chunks of a .glb: it wants whole words, and a buffer that is not empty.
bool has_odd_chunks(const Source& source) {
    const GltfContainer& at = source.container;
    const bool is_last = at.json_begin + at.json_size == gltf_word_at(source.bytes, 8);
    return at.json_size % 4 != 0 || at.bin_size % 4 != 0 || (at.bin_size == 0 && !is_last);
}

// The bytes with another text in the place of the JSON; chunks of a .glb behind the buffer are left out.
std::vector<uint8_t> with_json(const Source& source, std::string_view text) {
    const std::span<const uint8_t> content(reinterpret_cast<const uint8_t*>(text.data()), text.size());
    if (!source.container.binary) return {content.begin(), content.end()};
    constexpr size_t kLengthAt = 8;
    std::vector<uint8_t> bytes(source.bytes.begin(), source.bytes.begin() + kLengthAt + 4);
    append_chunk(bytes, kGlbJson, content, ' ');
    if (source.container.bin_size > 0)
        append_chunk(bytes, kGlbBin,
                     std::span(source.bytes).subspan(source.container.bin_begin, source.container.bin_size), 0);
    std::vector<uint8_t> length;
    stream::append_number(length, bytes.size(), kWord);
    std::copy(length.begin(), length.end(), bytes.begin() + kLengthAt);
    return bytes;
}

// Parses the JSON, checks it, and repairs what tinygltf does not read. Returns the notes on what is left out.
std::vector<std::string> check_json(Source& source) {
    const std::string_view text(reinterpret_cast<const char*>(source.bytes.data()) + source.container.json_begin,
                                source.container.json_size);
    expect_shallow_json(text, source.file);  // tinygltf walks extras and extensions recursively
    nlohmann::json root;
    try {
        root = nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        refuse_json(source.file, error.what());
    }
    if (!root.is_object())
        throw InputError(source.file, "", "is neither a .glb nor a JSON object", "give a glTF 2.0 file");
    const bool had_floats = mend_whole_numbers(root);
    check_gltf(root, {source.file, source.folder, source.container.binary, source.container.bin_size});
    MendedGltf mended = mend_gltf(root, source.folder);
    if (mended.changed || had_floats)
        source.bytes = with_json(source, root.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    else if (source.container.binary && has_odd_chunks(source))
        source.bytes = with_json(source, text);
    return std::move(mended.notes);
}

// Limits tinygltf's file access to the model's folder; by itself it would also search the working folder.
bool is_below(const std::string& path, const std::string& folder) {
    return path.rfind(folder + "/", 0) == 0 && !leaves_folder(path.substr(folder.size() + 1));
}

tinygltf::FsCallbacks folder_access(Source& source) {
    tinygltf::FsCallbacks callbacks{};
    callbacks.user_data = &source;
    callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
    callbacks.FileExists = [](const std::string& given, void* user) {
        const std::string path = with_slashes(given);
        std::error_code error;
        return is_below(path, static_cast<Source*>(user)->folder) && std::filesystem::is_regular_file(path, error);
    };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& path, void*) {
        try {
            *out = read_file(with_slashes(path), kMaxStageBytes);
            return true;
        } catch (const InputError& bad) {
            if (error) *error = bad.what();
            return false;
        }
    };
    return callbacks;
}

bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                  int size, void*) {
    if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
    return true;
}

// ": a; b", of what tinygltf wrote on lines of their own.
std::string on_one_line(const std::string& problem) {
    std::string text;
    for (const std::string& line : split(problem, '\n'))
        if (!line.empty()) text += (text.empty() ? ": " : "; ") + line;
    return text;
}

}  // namespace

ParsedGltf parse_gltf(const std::filesystem::path& path, std::vector<uint8_t> bytes) {
    Source source;
    source.file = path.string();
    source.folder = path.has_parent_path() ? path.parent_path().string() : ".";
    source.bytes = std::move(bytes);
    source.container = find_gltf_json(source.bytes, source.file);
    ParsedGltf parsed;
    parsed.notes = check_json(source);
    tinygltf::Model& model = parsed.model;
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(folder_access(source));
    loader.SetImageLoader(keep_encoded, nullptr);
    std::string problem, warning;
    bool ok = false;
    try {
        const auto size = static_cast<unsigned>(source.bytes.size());
        ok = source.container.binary
                 ? loader.LoadBinaryFromMemory(&model, &problem, &warning, source.bytes.data(), size, source.folder)
                 : loader.LoadASCIIFromString(&model, &problem, &warning,
                                              reinterpret_cast<const char*>(source.bytes.data()), size, source.folder);
    } catch (const std::exception& error) {
        problem = error.what();
    }
    // tinygltf drops what it cannot read and reports that in `problem`, even where it returns true.
    if (!ok || !problem.empty())
        throw InputError(source.file, "", "is no glTF that this program reads" + on_one_line(problem),
                         "see what a glTF validator says of it");
    return parsed;
}

}  // namespace neuvv::stage
