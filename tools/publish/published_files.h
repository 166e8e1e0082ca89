// What `neuvv publish` and `neuvv export` put beside a page as it is: streams and sounds.
#pragma once

#include <cstdint>
#include <filesystem>

namespace neuvv::tools {

// Whether the clip is a stream, which is copied. Throws InputError for one on a server.
bool is_stream_to_copy(const std::filesystem::path& clip);

// Throws RuntimeFailure where the output cannot be written. Returns its bytes.
uint64_t copy_stream(const std::filesystem::path& stream, const std::filesystem::path& output);

// A sound may be an address, which is downloaded. Throws as voctree::sound_here does.
void copy_sound(const std::filesystem::path& sound, const std::filesystem::path& output);

}  // namespace neuvv::tools
