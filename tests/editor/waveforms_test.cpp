// Waveforms that a thread reads.
#include "editor/waveforms.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "support/temporary_folder.h"
#include "support/wav_file.h"

namespace neuvv::test::waveforms_test {
namespace {

constexpr std::chrono::minutes kHangs{2};

struct WaveformsTest : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path wav = folder.path / "a.wav", other = folder.path / "b.wav";
    std::mutex mutex;
    std::condition_variable woken;
    int wakes = 0;
    editor::Waveforms waveforms{[this] {
        const std::lock_guard lock(mutex);
        ++wakes;
        woken.notify_all();
    }};

    // Waits until so many files have been read, or could not be.
    void wait_for_wakes(int count) {
        std::unique_lock lock(mutex);
        ASSERT_TRUE(woken.wait_for(lock, kHangs, [&] { return wakes >= count; }));
    }
    static void write(const std::filesystem::path& path, uint32_t samples) {
        write_wav(path, stereo_tone(samples), 2, media::kSoundRate);
    }
};

TEST_F(WaveformsTest, AreReadAndReadAgainWhenTheFileChanges) {
    write(wav, media::kSoundRate);
    EXPECT_EQ(waveforms.of(wav), nullptr);
    waveforms.follow({wav});
    wait_for_wakes(1);
    const auto first = waveforms.of(wav);
    ASSERT_TRUE(first);
    EXPECT_GT(first->largest(0.5, 1), 0.4);
    EXPECT_EQ(first->largest(1, 2), 0);
    write(other, 2 * media::kSoundRate);
    std::filesystem::rename(other, wav);  // at once, so that the thread does not read half of it
    waveforms.follow({wav});
    wait_for_wakes(2);
    ASSERT_TRUE(waveforms.of(wav));
    EXPECT_GT(waveforms.of(wav)->largest(1.9, 2), 0.4);
    EXPECT_EQ(first->largest(1, 2), 0) << "who has the old one keeps it";
    EXPECT_EQ(waveforms.of(other), nullptr);
}

TEST_F(WaveformsTest, WhatCannotBeReadIsReportedOnceAndReadLater) {
    write(other, 1000);
    std::ofstream(wav) << "no sound at all";
    waveforms.follow({wav, other});
    wait_for_wakes(2);
    EXPECT_EQ(waveforms.of(wav), nullptr);
    EXPECT_NE(waveforms.of(other), nullptr);
    EXPECT_NE(waveforms.take_problem().find("a.wav"), std::string::npos);
    EXPECT_EQ(waveforms.take_problem(), "");
    waveforms.follow({wav});
    std::filesystem::rename(other, wav);
    waveforms.follow({wav});
    wait_for_wakes(3);
    EXPECT_NE(waveforms.of(wav), nullptr);
    EXPECT_EQ(waveforms.take_problem(), "");
}

TEST_F(WaveformsTest, WhatIsNotDisplayedIsForgotten) {
    write(wav, 1000);
    write(other, 1000);
    waveforms.follow({wav, other});
    wait_for_wakes(2);
    waveforms.follow({other});
    EXPECT_EQ(waveforms.of(wav), nullptr);
    EXPECT_NE(waveforms.of(other), nullptr);
    waveforms.follow({wav, other});
    wait_for_wakes(3);
    EXPECT_NE(waveforms.of(wav), nullptr) << "and is read again when it is";
}

TEST_F(WaveformsTest, AreForgottenWhenNobodyWaitsForThem) {
    write(wav, 60 * media::kSoundRate);
    write(other, 1000);
    waveforms.follow({wav});
    waveforms.follow({other});
    for (int wake = 1; !waveforms.of(other); ++wake) wait_for_wakes(wake);
    EXPECT_EQ(waveforms.of(wav), nullptr);
    EXPECT_EQ(waveforms.take_problem(), "");
}

}  // namespace
}  // namespace neuvv::test::waveforms_test
