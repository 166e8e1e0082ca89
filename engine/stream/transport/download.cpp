#include "stream/transport/download.h"

#include <fmt/format.h>

#include "stream/transport/http_source.h"

namespace neuvv::stream {

std::vector<uint8_t> download(const std::string& address, uint64_t most_bytes, const std::stop_token& stop) {
    HttpSource source(address);
    if (source.size() > most_bytes)
        throw InputError(address, "", fmt::format("has more than {} MiB", most_bytes >> 20), "make it smaller");
    const std::stop_callback cancels(stop, [&] { source.cancel(); });
    return source.read(0, source.size());
}

}  // namespace neuvv::stream
