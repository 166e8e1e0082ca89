// Blocks on the disk.
#include "stream/transport/block_cache.h"

#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

#include "support/temporary_folder.h"

namespace neuvv::test::block_cache_test {
namespace {

using stream::BlockCache;

constexpr uint64_t kMany = uint64_t{1} << 30;

std::vector<uint8_t> bytes(size_t count, uint8_t first) {
    std::vector<uint8_t> all(count);
    std::iota(all.begin(), all.end(), first);
    return all;
}

struct BlockCacheTest : testing::Test {
    TemporaryFolder folder;
    const std::string address = "https://example.org/show.nvs";
    BlockCache cache(uint64_t limit = kMany, uint8_t beginning = 1) const {
        return {{folder.path, limit}, address, 5000, bytes(100, beginning)};
    }
    std::vector<std::filesystem::path> files() const {
        std::vector<std::filesystem::path> all;
        for (const auto& one : std::filesystem::recursive_directory_iterator(folder.path))
            if (one.is_regular_file()) all.push_back(one.path());
        return all;
    }
};

TEST_F(BlockCacheTest, KeepsBlocksForTheNextRun) {
    EXPECT_FALSE(cache().read(3, 1000));
    cache().write(3, bytes(1000, 7));
    EXPECT_EQ(cache().read(3, 1000), bytes(1000, 7));
    EXPECT_FALSE(cache().read(3, 999)) << "of another length";
    EXPECT_FALSE(cache().read(4, 1000));
    EXPECT_FALSE(cache(kMany, 2).read(3, 1000)) << "of a stream that was published again";
    EXPECT_EQ(files().size(), 1u);
    cache().forget();
    EXPECT_FALSE(cache().read(3, 1000));
    EXPECT_TRUE(files().empty());
}

TEST_F(BlockCacheTest, DamagedBlocksAreNotThere) {
    cache().write(3, bytes(1000, 7));
    const std::filesystem::path file = files().at(0);
    std::filesystem::resize_file(file, 700);
    EXPECT_FALSE(cache().read(3, 1000));
    cache().write(3, bytes(1000, 7));
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(500).put('x');
    EXPECT_FALSE(cache().read(3, 1000));
}

TEST_F(BlockCacheTest, WhatWasNotUsedForLongestGoesFirst) {
    constexpr uint64_t kLimit = 64'000;
    BlockCache one = cache(kLimit);
    for (uint64_t block = 0; block < 60; ++block) {
        one.write(block, bytes(1000, static_cast<uint8_t>(block)));
        // File systems tell times apart that are some milliseconds apart.
        for (const auto& file : files())
            std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) - std::chrono::seconds(1));
    }
    EXPECT_TRUE(one.read(0, 1000)) << "there was room; now it is the newest";
    for (uint64_t block = 60; block < 80; ++block) one.write(block, bytes(1000, static_cast<uint8_t>(block)));
    uint64_t all = 0;
    for (const auto& file : files()) all += std::filesystem::file_size(file);
    EXPECT_LE(all, kLimit + kLimit / 16 + 1000);
    EXPECT_GT(all, kLimit / 2);
    EXPECT_TRUE(one.read(0, 1000));
    EXPECT_FALSE(one.read(1, 1000));
    EXPECT_TRUE(one.read(79, 1000));
}

TEST_F(BlockCacheTest, WithoutRoomOrFolderNothingIsKept) {
    cache(0).write(1, bytes(1000, 7));
    EXPECT_FALSE(cache(0).read(1, 1000));
    EXPECT_TRUE(files().empty());
    BlockCache nowhere({"/dev/null/streams", kMany}, address, 5000, bytes(100, 1));
    nowhere.write(1, bytes(1000, 7));
    EXPECT_FALSE(nowhere.read(1, 1000));
}

}  // namespace
}  // namespace neuvv::test::block_cache_test
