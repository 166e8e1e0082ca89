// Damage as files suffer it from programs, disks and enemies.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace neuvv::fuzz {

using Random = std::mt19937_64;

// One to eight changes: bits, bytes, numbers of 1 to 8 bytes and numbers as text replaced by those that break programs;
// pieces removed, doubled, moved, or taken from `others`; the end cut off. Never larger than `limit` bytes.
std::string mutate(std::string bytes, const std::vector<std::string>& others, size_t limit, Random& random);

// The bytes of a sound .nvv or .nvpaint with damage behind its checksums, which fit it: the content of one chunk is
// mutated, or a chunk is missing, or two have changed places. At most `limit` bytes of content a chunk.
std::string mutate_chunks(const std::filesystem::path& sound, const std::vector<std::string>& others, size_t limit,
                          Random& random);

}  // namespace neuvv::fuzz
