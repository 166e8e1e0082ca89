#include "media/cryptomatte.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

namespace neuvv::media {

namespace {

constexpr const char* kLayer = "CryptoObject";  // as other renderers call it, so that programs find it

// MurmurHash3_x86_32 by Austin Appleby, with seed 0.
uint32_t murmur3(const std::string& text) {
    const auto mix = [](uint32_t block) { return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u; };
    uint32_t hash = 0;
    size_t at = 0;
    for (; at + 4 <= text.size(); at += 4) {
        uint32_t block = 0;
        std::memcpy(&block, text.data() + at, 4);
        hash = std::rotl(hash ^ mix(block), 13) * 5 + 0xe6546b64u;
    }
    uint32_t rest = 0;
    std::memcpy(&rest, text.data() + at, text.size() - at);
    if (at < text.size()) hash ^= mix(rest);
    hash ^= static_cast<uint32_t>(text.size());
    hash = (hash ^ hash >> 16) * 0x85ebca6bu;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
    return hash ^ hash >> 16;
}

// Its lowest bit is turned over where the exponent would be that of a denormal, an infinity or no number.
uint32_t bits_of_id(const std::string& name) {
    const uint32_t hash = murmur3(name), exponent = hash >> 23 & 255;
    return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

}  // namespace

float id_of_name(const std::string& name) {
    return std::bit_cast<float>(bits_of_id(name));
}

std::vector<std::string> id_channels() {
    std::vector<std::string> names;
    for (size_t pair = 0; pair < kIdRanks / 2; ++pair)
        for (const char channel : {'R', 'G', 'B', 'A'})
            names.push_back(fmt::format("{}{:02}.{}", kLayer, pair, channel));
    return names;
}

std::vector<float> id_values(const IdImage& image) {
    std::vector<float> ids, values;
    for (const std::string& name : image.names) ids.push_back(id_of_name(name));
    values.reserve(2 * kIdRanks * image.pixels.size());
    for (const auto& ranks : image.pixels)
        for (const IdRank& rank : ranks) {
            values.push_back(rank.coverage > 0 ? ids.at(rank.name) : 0);
            values.push_back(rank.coverage);
        }
    return values;
}

std::vector<std::pair<std::string, std::string>> id_attributes(const IdImage& image) {
    nlohmann::json manifest = nlohmann::json::object();
    for (const std::string& name : image.names) manifest[name] = fmt::format("{:08x}", bits_of_id(name));
    const std::string prefix = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", murmur3(kLayer)));
    return {{prefix + "name", kLayer},
            {prefix + "hash", "MurmurHash3_32"},
            {prefix + "conversion", "uint32_to_float32"},
            {prefix + "manifest", manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}};
}

}  // namespace neuvv::media
