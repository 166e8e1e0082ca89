// Writes a .wav of 16-bit samples.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

namespace neuvv::test {

// Samples of all channels, one time after the other.
inline void write_wav(const std::filesystem::path& path, const std::vector<int16_t>& samples, uint16_t channels,
                      uint32_t rate) {
    std::ofstream file(path, std::ios::binary);
    const auto number = [&](uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) file.put(static_cast<char>(value >> 8 * i));
    };
    const auto bytes = static_cast<uint32_t>(2 * samples.size());
    file << "RIFF";
    number(36 + bytes, 4);
    file << "WAVEfmt ";
    number(16, 4);
    number(1, 2);  // PCM
    number(channels, 2);
    number(rate, 4);
    number(rate * channels * 2, 4);
    number(channels * 2u, 2);
    number(16, 2);
    file << "data";
    number(bytes, 4);
    for (const int16_t sample : samples) number(static_cast<uint16_t>(sample), 2);
}

// A sine of 440 Hz, the right half as loud as the left.
inline std::vector<int16_t> stereo_tone(uint32_t samples, uint32_t rate = 48000) {
    std::vector<int16_t> tone;
    for (uint32_t i = 0; i < samples; ++i) {
        const double value = 16000 * std::sin(2 * std::numbers::pi * 440 * i / rate);
        tone.push_back(static_cast<int16_t>(std::lround(value)));
        tone.push_back(static_cast<int16_t>(std::lround(value / 2)));
    }
    return tone;
}

}  // namespace neuvv::test
