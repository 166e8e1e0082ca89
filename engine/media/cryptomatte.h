// Cryptomatte 1.2: which names cover a pixel how much, in channels from which compositing programs cut mattes by name.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace neuvv::media {

constexpr size_t kIdRanks = 6;  // how many names a pixel may have; those that cover it least are left out

struct IdRank {
    uint32_t name = 0;   // index into IdImage::names
    float coverage = 0;  // 0 to 1
};

// Row-major from the top left. Names that are equal are one.
struct IdImage {
    std::vector<std::string> names;
    std::vector<std::array<IdRank, kIdRanks>> pixels;  // by falling coverage; a coverage of 0 means no name
};

// The name's MurmurHash3_32 as a float that is neither infinite, denormal nor not a number.
float id_of_name(const std::string& name);

// The names of an image's channels, four for each pair of ranks: identifier, coverage, identifier, coverage.
std::vector<std::string> id_channels();
// Their values, pixel by pixel.
std::vector<float> id_values(const IdImage& image);
// What the header says of them: each attribute's name and text. The manifest has the names and their identifiers.
std::vector<std::pair<std::string, std::string>> id_attributes(const IdImage& image);

}  // namespace neuvv::media
