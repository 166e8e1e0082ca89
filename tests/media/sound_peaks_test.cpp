// Sounds reduced to peaks.
#include "media/sound_peaks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <random>

#include "support/input_error.h"
#include "support/temporary_folder.h"
#include "support/wav_file.h"

namespace neuvv::test::sound_peaks_test {
namespace {

constexpr double kBucket_s = media::kPeakBucket_s;

struct SoundPeaksTest : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path wav = folder.path / "a.wav";
    media::SoundPeaks read() const {
        return media::read_sound_peaks(wav, [] { return true; }).value();
    }
};

TEST_F(SoundPeaksTest, SilenceHasNone) {
    write_wav(wav, std::vector<int16_t>(2 * media::kSoundRate), 2, media::kSoundRate);
    const media::SoundPeaks peaks = read();
    EXPECT_EQ(peaks.size(), media::kSoundRate / media::kPeakBucket);
    EXPECT_EQ(peaks.largest(0, 1), 0);
}

TEST_F(SoundPeaksTest, AToneIsWhereItBegins) {
    std::vector<int16_t> samples(2 * media::kSoundRate);
    const std::vector<int16_t> tone = stereo_tone(media::kSoundRate);
    samples.insert(samples.end(), tone.begin(), tone.end());
    write_wav(wav, samples, 2, media::kSoundRate);
    const media::SoundPeaks peaks = read();
    EXPECT_EQ(peaks.largest(0, 1), 0);
    EXPECT_GT(peaks.largest(1, 1 + kBucket_s), 0.4) << "16000 of 32768, of the louder side";
    EXPECT_NEAR(peaks.largest(0, 2), 16000.0 / 32768, 1e-4);
    EXPECT_NEAR(peaks.largest(1.5, 1.6), 16000.0 / 32768, 1e-4);
}

TEST_F(SoundPeaksTest, OtherCountsOfChannelsAreReadToo) {
    for (const uint16_t channels : std::array<uint16_t, 3>{1, 3, 5}) {
        std::vector<int16_t> samples;
        for (uint32_t i = 0; i < media::kSoundRate / 2; ++i)
            samples.insert(samples.end(), channels, i < media::kSoundRate / 4 ? int16_t{0} : int16_t{12000});
        write_wav(wav, samples, channels, media::kSoundRate);
        const media::SoundPeaks peaks = read();
        EXPECT_EQ(peaks.largest(0, 0.25 - kBucket_s), 0) << channels;
        EXPECT_GT(peaks.largest(0.25 + kBucket_s, 0.5), 0.1) << channels;
    }
}

TEST_F(SoundPeaksTest, TheLastBucketMayBeShort) {
    std::vector<int16_t> samples(2 * (3 * media::kPeakBucket + 1));
    samples.back() = -32768;
    write_wav(wav, samples, 2, media::kSoundRate);
    const media::SoundPeaks peaks = read();
    EXPECT_EQ(peaks.size(), 4u);
    EXPECT_EQ(peaks.largest(0, 3 * kBucket_s), 0);
    EXPECT_EQ(peaks.largest(3 * kBucket_s, 4 * kBucket_s), 1) << "the loudest sample that there is";
    EXPECT_EQ(peaks.largest(2.5 * kBucket_s, 1e9), 1);
}

TEST_F(SoundPeaksTest, WhatIsBesideTheSoundIsSilent) {
    const media::SoundPeaks peaks(std::vector<uint16_t>{9000, 16384});
    EXPECT_EQ(peaks.largest(-1, 0), 0);
    EXPECT_EQ(peaks.largest(2 * kBucket_s, 1), 0);
    EXPECT_EQ(peaks.largest(kBucket_s, kBucket_s), 0) << "an empty time";
    EXPECT_EQ(peaks.largest(-1e300, 1e300), 0.5);
    EXPECT_EQ(media::SoundPeaks({}).largest(0, 1), 0);
}

// The levels give what a search of all buckets gives.
TEST_F(SoundPeaksTest, EveryRangeHasItsLargest) {
    std::mt19937 random(7);
    for (const size_t size : {1u, 2u, 7u, 33u}) {
        std::vector<uint16_t> buckets(size);
        for (uint16_t& bucket : buckets) bucket = static_cast<uint16_t>(random() % 32769);
        const media::SoundPeaks peaks(buckets);
        for (size_t from = 0; from < size; ++from)
            for (size_t to = from + 1; to <= size; ++to) {
                const auto begin = buckets.begin();
                const uint16_t most = *std::max_element(begin + static_cast<std::ptrdiff_t>(from),
                                                        begin + static_cast<std::ptrdiff_t>(to));
                EXPECT_EQ(peaks.largest(static_cast<double>(from) * kBucket_s, static_cast<double>(to) * kBucket_s),
                          static_cast<float>(most) / 32768)
                    << from << " to " << to << " of " << size;
            }
    }
}

TEST_F(SoundPeaksTest, ReadingCanBeStopped) {
    write_wav(wav, stereo_tone(10 * media::kSoundRate), 2, media::kSoundRate);
    int asked = 0;
    EXPECT_FALSE(media::read_sound_peaks(wav, [&] { return ++asked < 3; }));
    EXPECT_EQ(asked, 3) << "and nothing is read any more";
}

TEST_F(SoundPeaksTest, WhatIsNoSoundIsRefused) {
    std::ofstream(wav) << "no sound at all";
    expect_input_error([&] { read(); }, {"a.wav"});
}

}  // namespace
}  // namespace neuvv::test::sound_peaks_test
