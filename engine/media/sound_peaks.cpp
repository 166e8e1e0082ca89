#include "media/sound_peaks.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace neuvv::media {

namespace {

constexpr double kBucketTolerance = 1e-6;  // of a bucket: times that are so near to its edge are at the edge

// Gets a sound piece by piece, and makes its buckets.
class PeakMeter {
  public:
    void add(std::span<const StereoSample16> samples) {
        for (const StereoSample16& sample : samples) {
            if (samples_ % kPeakBucket == 0) buckets_.push_back(0);
            ++samples_;
            for (const int16_t side : sample)
                buckets_.back() = std::max(buckets_.back(), static_cast<uint16_t>(std::abs(int{side})));
        }
    }
    SoundPeaks peaks() { return SoundPeaks(std::move(buckets_)); }

  private:
    std::vector<uint16_t> buckets_;
    size_t samples_ = 0;
};

}  // namespace

SoundPeaks::SoundPeaks(std::vector<uint16_t> buckets) : levels_{std::move(buckets)} {
    while (levels_.back().size() > 1) {
        const std::vector<uint16_t>& fine = levels_.back();
        std::vector<uint16_t> coarse((fine.size() + 1) / 2);
        for (size_t i = 0; i < fine.size(); ++i) coarse[i / 2] = std::max(coarse[i / 2], fine[i]);
        levels_.push_back(std::move(coarse));
    }
}

float SoundPeaks::largest(double from_s, double to_s) const {
    const auto end = static_cast<double>(size());
    const double first_bucket = std::floor(from_s / kPeakBucket_s + kBucketTolerance);
    const double end_bucket = std::ceil(to_s / kPeakBucket_s - kBucketTolerance);
    if (!(from_s < to_s) || !(first_bucket < end) || !(end_bucket > 0)) return 0;
    auto first = static_cast<size_t>(std::max(first_bucket, 0.0)),
         last = static_cast<size_t>(std::min(end_bucket, end));
    uint16_t most = 0;
    // What of the range is no whole pair of buckets is looked at here, the rest on the next, coarser level.
    for (size_t level = 0; first < last; ++level, first /= 2, last /= 2) {
        if (first % 2 == 1) most = std::max(most, levels_[level][first++]);
        if (last % 2 == 1) most = std::max(most, levels_[level][--last]);
    }
    return static_cast<float>(most) / 32768;
}

SoundPeaks peaks_of(const Sound& sound) {
    PeakMeter meter;
    meter.add(sound.samples);
    return meter.peaks();
}

std::optional<SoundPeaks> read_sound_peaks(const SoundFile& file, const std::function<bool()>& goes_on) {
    PeakMeter meter;
    bool stopped = false;
    decode_sound(file, [&](std::span<const StereoSample16> samples) {
        meter.add(samples);
        stopped = !goes_on();
        return !stopped;
    });
    if (stopped) return std::nullopt;
    return meter.peaks();
}

}  // namespace neuvv::media
