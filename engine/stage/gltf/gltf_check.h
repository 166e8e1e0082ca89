// Internal to this module: checks the JSON of a glTF file before tinygltf reads it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace neuvv::stage {

// Where a document is.
struct GltfPlace {
    std::string file, folder;
    bool binary = false;
    size_t bin_size = 0;  // bytes of a .glb's second chunk
};

// Throws InputError with the JSON location where members are missing or have the wrong type, where buffer views leave
// their buffers, for URIs that leave the folder, and for required extensions that are not known.
void check_gltf(const nlohmann::json& root, const GltfPlace& source);

// The bytes that a data URI holds; nothing where it is none in base64.
std::optional<uint64_t> bytes_of_data_uri(std::string_view uri);

// Whether an extension is read, so that a file that requires it is not refused.
bool is_read_extension(const std::string& name);

// A path with slashes for the backslashes of Windows.
std::string with_slashes(std::string path);
// The path that a uri names.
std::string path_of_uri(const std::string& uri);

// Whether a relative path may lead out of the folder. Percent escapes must have been decoded before (path_of_uri), so
// that %2e%2e is recognised as `..`.
bool leaves_folder(const std::string& relative);

}  // namespace neuvv::stage
