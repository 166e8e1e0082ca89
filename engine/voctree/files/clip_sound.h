// The sound of a clip: the file beside it, on the disk or on the clip's server.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>

#include "media/sound.h"

namespace neuvv::voctree {

constexpr uint64_t kMostServedSound = uint64_t{256} << 20;  // bytes

// The file beside a clip on the disk that has its sound, if it has any: NAME.m4a for NAME.nvv and NAME.nvs.
std::filesystem::path sound_file(const std::filesystem::path& clip);

// The same file where it is there, and for a stream on a server its address: https://host/NAME.m4a for
// https://host/NAME.nvs, with the same query. The server is asked once. Nothing where it has none, or something else
// under that name. Throws stream::ServerProblem where the server does not answer now.
std::optional<std::filesystem::path> sound_beside(const std::filesystem::path& clip);

// A sound to be read: a file as it is, and an address with its content, which is downloaded; it may take long. Throws
// InputError where it has more than kMostServedSound or cannot be downloaded, and soon after `stop` was requested.
media::SoundFile sound_here(const std::filesystem::path& file_or_address, const std::stop_token& stop = {});

}  // namespace neuvv::voctree
