// Streams from a server, one that is slow, busy, or sends something else.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "stream/http_source.h"
#include "stream/nvs.h"
#include "stream/random_slice.h"
#include "support/child_process.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv::test::http_test {
namespace {

struct HttpTest : testing::Test {
    TemporaryFolder folder;
    std::vector<stream::Slice> decoded;    // by the encoder
    std::unique_ptr<ChildProcess> server;  // tests/stream/http_server.py
    int port = 0;

    void SetUp() override {
        write(3);
        const std::filesystem::path log = folder.path / "server.log";
        server = std::make_unique<ChildProcess>(
            std::vector<std::string>{"/usr/bin/env", "python3", NEUVV_SOURCE_DIR "/tests/stream/http_server.py",
                                     folder.path.string()},
            log);
        ASSERT_TRUE(server->until([&] { return bool(std::ifstream(log) >> port) && port != 0; }))
            << "is python3 there?";
    }
    // Groups of one frame.
    void write(uint32_t frames) {
        stream::Steps steps;
        steps.fill(6);
        stream::Writer writer(folder.path / "show.nvs", 25, frames, frames);
        for (uint32_t i = 0; i < frames; i++) {
            std::vector<stream::FrameSymbols> one;
            one.push_back(stream::encode(random_slice(i + 1, 8, 20'000, 1), steps, {}, decoded.emplace_back()));
            stream::Group group;
            group.format = {8, 1, 100'000};
            writer.add(group, one);
        }
        EXPECT_GT(writer.finish(), 2 * stream::HttpSource::kBlock) << "else it is no test of blocks";
    }
    std::string address(const std::string& mode) const {
        return fmt::format("http://127.0.0.1:{}/{}/show.nvs", port, mode);
    }
    void expect_plays(const std::string& mode) {
        stream::Reader reader(address(mode));
        ASSERT_EQ(reader.index().frames.size(), decoded.size());
        for (const uint32_t frame : {2u, 0u, 1u, 2u}) EXPECT_EQ(reader.frame(frame)->planes, decoded[frame].planes);
    }
    void expect_refused(const std::string& mode, const std::string& problem) {
        expect_input_error(
            [&] {
                stream::Reader reader(address(mode));
                for (uint32_t i = 0; i < 3; i++) reader.frame(i);
            },
            {"show.nvs", problem});
    }
};

TEST_F(HttpTest, PlaysFromAServer) {
    expect_plays("ok");
    expect_plays("redirect");
}

TEST_F(HttpTest, WhatMayPassIsToldFromWhatDoesNot) {
    EXPECT_THROW(stream::Reader reader(address("busy-always")), stream::ServerProblem);
    EXPECT_THROW(stream::Reader reader("http://127.0.0.1:1/show.nvs"), stream::ServerProblem);
    try {
        stream::Reader reader(address("missing"));
        FAIL() << "it is not there";
    } catch (const stream::ServerProblem&) {
        FAIL() << "and will not be";
    } catch (const InputError&) {
    }
    stream::Reader reader(address("changed"));
    EXPECT_FALSE(reader.has_failed());
    EXPECT_THROW(reader.frame(2), InputError);
    EXPECT_TRUE(reader.has_failed()) << "who opens it again opens it anew";
}

TEST_F(HttpTest, WhoWaitsForAServerCanBeStopped) {
    stream::Reader reader(address("slow"));
    std::thread waiting([&] { EXPECT_THROW(reader.frame(2), stream::ServerProblem); });
    reader.cancel();
    waiting.join();
    EXPECT_THROW(reader.frame(1), stream::ServerProblem);
}

TEST_F(HttpTest, PlaysFromABadServer) {
    expect_plays("slow");
    expect_plays("busy");
    expect_plays("breaks");
}

TEST_F(HttpTest, SaysWhatIsWrongWithAServer) {
    expect_refused("missing", "answers 404");
    expect_refused("busy-always", "answers 503");
    expect_refused("breaks-always", "cannot be read");
    expect_refused("circle", "redirects");
    expect_refused("file", "cannot be read");
    expect_refused("whole", "not by ranges");
    expect_refused("other-range", "another range");
    expect_refused("changed", "was changed");
    expect_refused("damaged", "damaged");
    server.reset();
    expect_input_error([] { stream::Reader reader("http://127.0.0.1:9/show.nvs"); }, {"127.0.0.1:9", "cannot be read"});
}

}  // namespace
}  // namespace neuvv::test::http_test
