// How loud a sound is over its length, coarsely: what a drawing of its waveform needs, in little memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "media/sound.h"

namespace neuvv::media {

constexpr uint32_t kPeakBucket = 240;                                            // samples
constexpr double kPeakBucket_s = static_cast<double>(kPeakBucket) / kSoundRate;  // 5 ms

// The largest amplitude of each bucket of a sound, and, so that long times are found as fast as short ones, of every 2,
// 4, 8 and so on of them. It takes 800 bytes a second: 12 MB for the longest sound that can be read.
class SoundPeaks {
  public:
    // The buckets in order, each as a share of 32768.
    explicit SoundPeaks(std::vector<uint16_t> buckets);

    // The number of buckets. The last one may reach beyond the end of the sound.
    size_t size() const { return levels_.front().size(); }

    // The largest amplitude of either side in the buckets that the time from `from_s` up to `to_s` touches, 0 to 1; 0
    // where the sound has not begun or is over, and for an empty time.
    float largest(double from_s, double to_s) const;

  private:
    std::vector<std::vector<uint16_t>> levels_;  // never empty; each has half as many as the one before
};

// Of a sound that is in memory.
SoundPeaks peaks_of(const Sound& sound);

// Of a file, of which never more is in memory than one decoded packet. Asks `goes_on` again and again; nullopt where it
// has returned false. Throws what read_sound throws.
std::optional<SoundPeaks> read_sound_peaks(const SoundFile& file, const std::function<bool()>& goes_on);

}  // namespace neuvv::media
