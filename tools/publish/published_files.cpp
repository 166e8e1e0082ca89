#include "tools/publish/published_files.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/platform.h"
#include "stream/transport/byte_source.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::tools {

bool is_stream_to_copy(const std::filesystem::path& clip) {
    if (voctree::kind_of(clip) != voctree::ClipKind::kStream) return false;
    if (stream::is_address(clip))
        throw InputError(clip.string(), "", "is on a server", "download it, and its sound beside it");
    return true;
}

uint64_t copy_stream(const std::filesystem::path& stream, const std::filesystem::path& output) {
    std::error_code error;
    std::filesystem::copy_file(stream, output, error);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot be written: {}", output.string(), error.message()));
    return std::filesystem::file_size(output);
}

void copy_sound(const std::filesystem::path& sound, const std::filesystem::path& output) {
    const media::SoundFile file = voctree::sound_here(sound);
    const std::vector<uint8_t> bytes = file.bytes ? *file.bytes : read_file(file.path);
    write_file_atomically(output, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

}  // namespace neuvv::tools
