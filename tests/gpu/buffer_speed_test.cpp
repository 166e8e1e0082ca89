// The times of a device's profiles of long arrays: measured, compared, kept in a file and read again, also where
// somebody has changed the file.
#include "gpu/buffer_speed.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "base/seconds.h"
#include "support/gpu_test.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

using BufferSpeed = GpuTest;

TEST_F(BufferSpeed, IsMeasuredForBothProfiles) {
    const double begin_s = seconds_now();
    const gpu::ProfileTimes times = gpu::measure_profiles(device());
    EXPECT_GT(times.texel_ms, 0);
    EXPECT_GT(times.storage_ms, 0);
    EXPECT_LT(times.texel_ms + times.storage_ms, 1e3 * (seconds_now() - begin_s)) << "each is one of several turns";
}

TEST(ProfileTimes, ChooseStorageOnlyWhereItIsClearlyFaster) {
    EXPECT_EQ(gpu::faster({1, 0.8}), gpu::BufferProfile::kStorage);
    EXPECT_EQ(gpu::faster({1, 0.95}), gpu::BufferProfile::kTexel) << "measurements differ as much";
    EXPECT_EQ(gpu::faster({1, 1.5}), gpu::BufferProfile::kTexel);
}

struct KeptTimes : ::testing::Test {
    TemporaryFolder folder;
    const std::filesystem::path file = folder.path / "times.json";
    gpu::DeviceSummary card = {.name = "Card", .driver = "driver 1.2"};

    std::optional<gpu::ProfileTimes> read_text(const std::string& text) const {
        std::ofstream(file, std::ios::binary) << text;
        return gpu::read_profile_times(file, card);
    }
    std::string written() const {
        gpu::write_profile_times(file, card, {2.5, 1.25});
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
};

TEST_F(KeptTimes, AreReadAsTheyWereWritten) {
    ASSERT_FALSE(written().empty());
    const auto times = gpu::read_profile_times(file, card);
    ASSERT_TRUE(times);
    EXPECT_EQ(times->texel_ms, 2.5);
    EXPECT_EQ(times->storage_ms, 1.25);
}

TEST_F(KeptTimes, AreThoseOfOneDeviceAndDriver) {
    written();
    gpu::DeviceSummary other = card;
    other.driver = "driver 1.3";
    EXPECT_FALSE(gpu::read_profile_times(file, other));
    EXPECT_NE(gpu::profile_times_file(other), gpu::profile_times_file(card));
    other = card;
    other.name = "Another card";
    EXPECT_FALSE(gpu::read_profile_times(file, other));
    EXPECT_NE(gpu::profile_times_file(other), gpu::profile_times_file(card));
}

TEST_F(KeptTimes, AreMeasuredAgainWhereTheFileIsDamaged) {
    const std::string good = written();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    ASSERT_TRUE(read_text(good));
    for (const std::string& bad :
         {std::string(), std::string("[]"), std::string("{"), std::string(5000, ' ') + good, with("2.5", "-1"),
          with("2.5", "0"), with("2.5", "1e99"), with("2.5", "\"2.5\""), with("1.25", "null"),
          with("storage_ms", "other"), with("Card", "Cart"), with("NeuVV", "Neu")})
        EXPECT_FALSE(read_text(bad)) << bad.substr(0, 200);
    EXPECT_FALSE(gpu::read_profile_times(folder.path, card)) << "a folder";
    EXPECT_FALSE(gpu::read_profile_times(folder.path / "nothing", card));
}

TEST_F(KeptTimes, AreInBoundsWhateverTheFileSays) {
    const std::string good = written();
    std::mt19937 random(7);
    const auto below = [&](size_t end) { return std::uniform_int_distribution<size_t>(0, end - 1)(random); };
    for (int i = 0; i < 300; ++i) {
        std::string text = good;
        for (size_t changes = 1 + below(4); changes > 0; --changes)
            text[below(text.size())] = static_cast<char>(below(256));
        text.resize(1 + below(text.size()));
        if (i % 2) text += good.substr(std::min(text.size(), good.size()));
        if (const auto times = read_text(text)) {
            EXPECT_GT(times->texel_ms, 0) << text;
            EXPECT_GT(times->storage_ms, 0) << text;
            EXPECT_LT(times->texel_ms + times->storage_ms, 1e7) << text;
        }
    }
}

}  // namespace
}  // namespace neuvv::test
