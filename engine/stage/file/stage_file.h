// A stage's file, a .gltf or .glb: its JSON, which can be edited, and its bytes. Saving changes only what was edited.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "stage/file/stage_json.h"

namespace neuvv::stage {

constexpr uint64_t kMaxStageBytes = uint64_t{1} << 30;
constexpr uint64_t kMaxStageJsonBytes = uint64_t{1} << 26;

struct StageFile {
    std::filesystem::path path;  // URIs are relative to its folder
    StageJson json;              // the document, as edited

    // The content of the file when it was last read or saved. Copies of a StageFile share it.
    struct Saved {
        std::vector<uint8_t> bytes;
        bool binary = false;                   // whether it is a .glb, as its first four bytes say
        size_t json_begin = 0, json_size = 0;  // in `bytes`
        StageJson json;
        bool on_disk = true;  // false for a new file (make_stage_file) that was not saved yet
    };
    std::shared_ptr<const Saved> saved;
};

// Throws InputError for a damaged container, invalid JSON or UTF-8, and a member that an object has twice. Whether the
// JSON is valid glTF is not checked.
StageFile read_stage_file(const std::filesystem::path& path);
// Throws InputError where the file on the disk is not the one that was read or saved last, because another program has
// written it.
void expect_unchanged(const StageFile& file);
// A new file of this JSON, not on the disk yet; it is a .glb if `path` ends so. Throws InputError as read_stage_file.
StageFile make_stage_file(const std::filesystem::path& path, const std::string& json_text);

// The file's bytes with its edits: every value that did not change keeps its old bytes, and so do the other chunks of a
// .glb. Without edits these are the old bytes. Throws InputError where a .glb would grow beyond 4 GiB.
std::vector<uint8_t> stage_bytes(const StageFile& file);

// The file under another path; nothing is written. If the folder differs, relative URIs are rewritten so that they name
// the same files. Throws InputError where buffers or images would lie outside of the new folder, as load_gltf refuses
// those.
StageFile moved_to(StageFile file, const std::filesystem::path& path);

// Moves the file to `path` (moved_to) and writes its stage_bytes there atomically. Throws InputError where moved_to
// does, and for a .glb under the name of a .gltf or the other way round.
void save_stage_file(StageFile& file, const std::filesystem::path& path);

// The absolute path of a file, which need not exist: links and `..` are resolved as far as the path exists.
std::filesystem::path absolute_path(const std::filesystem::path& file);

// Between a URI with percent escapes ("my%20clip.nvv") and a path.
std::string decoded_uri(const std::string& uri);
std::string encoded_uri(const std::string& path);

// The file that a relative URI of the stage names; `..` is allowed. Throws InputError at `place` for absolute paths,
// schemes (http:, file:, data:), backslashes and empty URIs.
std::filesystem::path file_of_uri(const StageFile& file, const std::string& uri, const std::string& place);
// The inverse: a URI relative to the stage for any file.
std::string uri_of_file(const StageFile& file, const std::filesystem::path& named);

// The clip or the sound that a performer's URI names: the absolute path of a file (file_of_uri), or as it is written an
// address on a server, http:// or https://. Throws InputError as file_of_uri does.
std::filesystem::path file_or_address_of_uri(const StageFile& file, const std::string& uri, const std::string& place);
// The inverse.
std::string uri_of_file_or_address(const StageFile& file, const std::filesystem::path& named);

}  // namespace neuvv::stage
