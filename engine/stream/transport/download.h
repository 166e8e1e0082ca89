// A whole file from a server, by the rules of HttpSource: its checks, redirects, repetitions and kept blocks.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

namespace neuvv::stream {

// Throws InputError where the file has more than `most_bytes` or cannot be read, ServerProblem where that may pass and
// soon after `stop` was requested.
std::vector<uint8_t> download(const std::string& address, uint64_t most_bytes, const std::stop_token& stop = {});

}  // namespace neuvv::stream
