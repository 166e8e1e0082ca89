// A stage as the file that it is: a .gltf or .glb, its JSON to be edited, and a way back to the disk that changes
// nothing but what was edited.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "stage/stage_json.h"

namespace neuvv::stage {

constexpr uint64_t kMaxStageBytes = uint64_t{1} << 30;
constexpr uint64_t kMaxStageJsonBytes = uint64_t{1} << 26;

struct StageFile {
    std::filesystem::path path;  // relative URIs begin at its folder
    StageJson json;              // what an edit changes; copies of the file share all else

    // What `path` held when it was read or saved last. Copies share it.
    struct Saved {
        std::vector<uint8_t> bytes;
        bool binary = false;  // .glb, told by content
        size_t json_begin = 0, json_size = 0;
        StageJson json;
        bool on_disk = true;  // else no file was there yet: make_stage_file
    };
    std::shared_ptr<const Saved> saved;
};

// Throws InputError for no container or JSON, a member that is said twice, invalid UTF-8. Nothing of glTF is checked.
StageFile read_stage_file(const std::filesystem::path& path);
// A new one that is not on the disk yet; a .glb if it is named so.
StageFile make_stage_file(const std::filesystem::path& path, const std::string& json_text);

// The file with its edits: every value that did not change stands there in its old bytes, and so do the other chunks of
// a .glb. Without edits: the old bytes.
std::vector<uint8_t> stage_bytes(const StageFile& file);

// The file under another path, not written there. In another folder relative URIs are rewritten so that they name the
// same files. Refused (InputError): buffers and images that would lie outside of the new folder, as no reader may
// follow those there.
StageFile moved_to(StageFile file, const std::filesystem::path& path);

// Writes stage_bytes of the file moved_to `path`, atomically, which then is the file's. Refused as well (InputError): a
// .glb under the name of a .gltf or the other way round.
void save_stage_file(StageFile& file, const std::filesystem::path& path);

// One name for a file, there or not: absolute, links and .. resolved as far as it is there.
std::filesystem::path absolute_path(const std::filesystem::path& file);

// URIs name files with escapes: "my%20clip.nvv".
std::string decoded_uri(const std::string& uri);
std::string encoded_uri(const std::string& path);

// The file that a relative URI of the stage names; `..` is allowed. Throws InputError at `place` for absolute paths,
// schemes (http:, file:, data:), backslashes and empty ones.
std::filesystem::path file_of_uri(const StageFile& file, const std::string& uri, const std::string& place);
// The other way: a relative URI of the stage for any file.
std::string uri_of_file(const StageFile& file, const std::filesystem::path& named);

}  // namespace neuvv::stage
