#include "voctree/files/clip_sound.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "stream/transport/byte_source.h"
#include "stream/transport/download.h"

namespace neuvv::voctree {

namespace {

// The address of the sound beside a stream; nothing where the address does not end as a stream's.
std::optional<std::string> served_sound_file(const std::string& stream) {
    constexpr std::string_view kEnding = ".nvs";
    const size_t host = stream.find("://") + 3, end = std::min(stream.find_first_of("?#"), stream.size());
    const std::string_view place = std::string_view(stream).substr(0, end);
    if (!place.ends_with(kEnding) || place.find('/', host) == std::string_view::npos) return std::nullopt;
    return std::string(place.substr(0, end - kEnding.size())) + ".m4a" + stream.substr(end);
}

// Whether the server has an .mp4 there: some servers send a page for whatever they do not have.
bool has_served_sound(const std::string& address) {
    constexpr std::string_view kMark = "ftyp";  // after the length of the first box
    try {
        const auto source = stream::open_source(address);
        if (source->size() < 4 + kMark.size()) return false;
        const std::vector<uint8_t> mark = source->read(4, kMark.size());
        return std::ranges::equal(mark, kMark);
    } catch (const stream::ServerProblem&) {
        throw;
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace

std::filesystem::path sound_file(const std::filesystem::path& clip) {
    return std::filesystem::path(clip).replace_extension(".m4a");
}

std::optional<std::filesystem::path> sound_beside(const std::filesystem::path& clip) {
    if (stream::is_address(clip)) {
        const std::optional<std::string> address = served_sound_file(clip.string());
        if (!address || !has_served_sound(*address)) return std::nullopt;
        return *address;
    }
    std::error_code error;
    if (!std::filesystem::is_regular_file(sound_file(clip), error)) return std::nullopt;
    return sound_file(clip);
}

media::SoundFile sound_here(const std::filesystem::path& file_or_address, const std::stop_token& stop) {
    if (!stream::is_address(file_or_address)) return file_or_address;
    return {file_or_address, std::make_shared<const std::vector<uint8_t>>(
                                 stream::download(file_or_address.string(), kMostServedSound, stop))};
}

}  // namespace neuvv::voctree
