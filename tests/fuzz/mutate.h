// Damages files, as programs, disks and attackers do.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace neuvv::fuzz {

using Random = std::mt19937_64;

// Makes one to eight changes: replaces bits, bytes, numbers of 1 to 8 bytes or numbers in text by values that tend to
// break programs; removes, doubles or moves pieces, or inserts pieces of `others`; cuts off the end. The result has at
// most `limit` bytes.
std::string mutate(std::string bytes, const std::vector<std::string>& others, size_t limit, Random& random);

// The bytes of a valid .nvv or .nvpaint with damaged content and valid checksums: the content of one chunk is mutated,
// a chunk is missing, or two are swapped. Each chunk has at most `limit` bytes of content.
std::string mutate_chunks(const std::filesystem::path& sound, const std::vector<std::string>& others, size_t limit,
                          Random& random);

}  // namespace neuvv::fuzz
