// Whole files from a server.
#include "stream/transport/download.h"

#include <gtest/gtest.h>

#include <future>

#include "base/platform.h"
#include "stream/served_stream.h"
#include "support/input_error.h"

namespace neuvv::test::download_test {
namespace {

struct DownloadTest : testing::Test, ServedStream {
    void SetUp() override { start(3); }
};

TEST_F(DownloadTest, AFileComesWhole) {
    EXPECT_EQ(stream::download(address("ok"), uint64_t{1} << 30), read_file(file));
    EXPECT_EQ(stream::download(address("redirect"), std::filesystem::file_size(file)), read_file(file));
}

TEST_F(DownloadTest, WhatIsTooLargeOrMissingIsRefused) {
    const uint64_t size = std::filesystem::file_size(file);
    expect_input_error([&] { stream::download(address("ok"), size - 1); }, {"show.nvs", "MiB"});
    expect_input_error([&] { stream::download(address("missing"), size); }, {"show.nvs", "404"});
}

TEST_F(DownloadTest, ADownloadThatWaitsIsStopped) {
    ASSERT_GT(std::filesystem::file_size(file), 2 << 18) << "else the gate lets all of it through";
    std::stop_source stop;
    auto waiting = std::async(std::launch::async,
                              [&] { return stream::download(address("gate"), uint64_t{1} << 30, stop.get_token()); });
    stop.request_stop();  // the server never sends the end of the file
    EXPECT_THROW(waiting.get(), stream::ServerProblem);
}

}  // namespace
}  // namespace neuvv::test::download_test
