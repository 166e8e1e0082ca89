// Sound by libav*: what a file has is read as a whole, and a video gets a track.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace neuvv::media {

constexpr uint32_t kSoundRate = 48000;  // samples a second, of all sounds in memory
constexpr uint32_t kSoundHop = 1024;    // samples that are made at a time

// Left and right; 1 is as loud as a file can be.
using StereoSample = std::array<float, 2>;

// The same as files mostly have it: 32767 is as loud as a file can be.
using StereoSample16 = std::array<int16_t, 2>;

// A sound that was read. It takes 192 KB a second.
struct Sound {
    std::vector<StereoSample16> samples;
    double length_s() const { return static_cast<double>(samples.size()) / kSoundRate; }
};

// A file that has a sound: on the disk, unless its content is given.
struct SoundFile {
    template <std::convertible_to<std::filesystem::path> Path>
    SoundFile(const Path& on_disk) : path(on_disk) {}  // implicit, as this is the usual case
    SoundFile(std::filesystem::path name, std::shared_ptr<const std::vector<uint8_t>> content)
        : path(std::move(name)), bytes(std::move(content)) {}

    std::filesystem::path path;  // or the address: errors name the file by it
    std::shared_ptr<const std::vector<uint8_t>> bytes;
};

constexpr double kMaxSound_s = 4 * 3600;

// Reads the first sound of a file: .wav, .flac, .ogg, .mp3, .m4a, .mp4, .mov, .mkv, .webm or .avi. One channel is heard
// from both sides; of more than two, libswresample makes two. A track that begins later than its file has silence
// first, and so has a gap; what is damaged is left out. Throws InputError where it has none, cannot be read or decoded,
// or lasts longer than kMaxSound_s.
Sound read_sound(const SoundFile& file);

// Takes the next samples of a sound that is being read. Returns whether more are wanted.
using TakeSamples = std::function<bool(std::span<const StereoSample16>)>;

// Reads a sound as read_sound does, but keeps none of it: `take` gets all samples in order, some at a time.
void decode_sound(const SoundFile& file, const TakeSamples& take);

// Fills in the next kSoundHop samples.
using NextSamples = std::function<void(std::array<StereoSample, kSoundHop>&)>;

// Throws RuntimeFailure where add_sound() would, for want of an encoder.
void expect_sound_encoder();

// Gives an .mp4 of a VideoWriter or of join_videos a track (AAC, 192 kbit/s) that is as long as the video, whose images
// are not encoded again. A comment stays. The file is replaced when all is written. Throws InputError where it is no
// such video, RuntimeFailure where it cannot be written or there is no encoder.
void add_sound(const std::filesystem::path& video, const NextSamples& next);

// Writes an .m4a (AAC, 192 kbit/s), atomically. Throws RuntimeFailure where it cannot be written or there is no
// encoder.
void write_sound(const std::filesystem::path& path, const Sound& sound);

}  // namespace neuvv::media
