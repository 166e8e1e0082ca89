// Streams from a server, one that is slow, busy, or sends something else.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <thread>

#include "stream/served_stream.h"
#include "support/input_error.h"

namespace neuvv::test::http_test {
namespace {

struct HttpTest : testing::Test, ServedStream {
    void SetUp() override { start(3); }
    void expect_plays(const std::string& mode) {
        stream::Reader reader(address(mode));
        ASSERT_EQ(reader.index().frames.size(), decoded.size());
        for (const uint32_t frame : {2u, 0u, 1u, 2u}) EXPECT_EQ(reader.frame(frame)->planes, decoded[frame].planes);
    }
    void expect_refused(const std::string& mode, const std::string& problem) {
        expect_input_error(
            [&] {
                stream::Reader reader(address(mode));
                for (uint32_t i = 0; i < 3; ++i) reader.frame(i);
            },
            {"show.nvs", problem});
    }
};

TEST_F(HttpTest, PlaysFromAServer) {
    expect_plays("ok");
    expect_plays("redirect");
}

TEST_F(HttpTest, TheNextFramesAreFetchedMeanwhile) {
    stream::Reader reader(address("ahead"));
    reader.frame(0);
    const std::string last = fmt::format("ahead to {}", std::filesystem::file_size(file) - 1);
    ASSERT_TRUE(server->until([&] { return read_text(log).find(last) != std::string::npos; })) << read_text(log);
    server.reset();
    for (const uint32_t frame : {1u, 2u}) EXPECT_EQ(reader.frame(frame)->planes, decoded[frame].planes);
    EXPECT_THROW(stream::Reader again(address("ahead")), stream::ServerProblem);
}

TEST_F(HttpTest, WhatWasPlayedComesFromTheDisk) {
    const auto requests = [&](const std::string& of) {
        const std::string text = read_text(log);
        size_t count = 0;
        for (size_t at = text.find(of); at != std::string::npos; at = text.find(of, at + 1)) ++count;
        return count;
    };
    const auto is_sent = [&] { return requests("ok to ") == requests("ok sends to "); };
    expect_plays("ok");
    // What has come was logged before it was sent; that it was sent may be logged later.
    ASSERT_TRUE(server->until(is_sent)) << read_text(log);
    const std::string asked = read_text(log);
    EXPECT_NE(asked.find(fmt::format("ok to {}\n", std::filesystem::file_size(file) - 1)), std::string::npos) << asked;
    stream::Reader again(address("ok"));  // asks for the first block, to see whether it is the same stream
    const uint64_t end = stream::HttpSource::kBlock - 1;
    const std::string first_block = fmt::format("ok sends to {0}\nok to {0}\n", end);
    ASSERT_TRUE(server->until([&] { return read_text(log) == asked + first_block; })) << read_text(log);
    server.reset();
    for (const uint32_t frame : {0u, 1u, 2u}) EXPECT_EQ(again.frame(frame)->planes, decoded[frame].planes);
}

// A header of more than a block: what was damaged on its way must not be read from the disk again.
TEST_F(HttpTest, ADamagedHeadIsNotKept) {
    constexpr uint32_t kGroups = 2, kFrames = 800;
    stream::Writer writer(file, 25, kGroups * kFrames, kGroups);
    stream::QuantisedSlice first;
    stream::Steps steps;
    steps.fill(60);
    const stream::FrameSymbols frame = stream::encode(random_slice(1, 2, 20, 0), steps, {}, first);
    stream::Group group;
    group.format = {2, 0, 100};
    for (uint32_t i = 0; i < kGroups; ++i) writer.add(group, std::vector(kFrames, frame));
    writer.finish();
    ASSERT_GT(stream::header_bytes(kGroups, kGroups * kFrames), stream::HttpSource::kBlock);
    expect_input_error([&] { stream::Reader reader(address("damaged-second")); }, {"the index", "damaged"});
    stream::Reader again(address("damaged-second"));
    EXPECT_EQ(again.frame(kFrames)->planes, first.planes);
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
    ASSERT_GT(std::filesystem::file_size(file), 2 << 18) << "else the gate lets all of it through";
    stream::Reader reader(address("gate"));  // the server never sends the end of the file
    std::thread waiting([&] { EXPECT_THROW(reader.frame(2), stream::ServerProblem); });
    reader.cancel();
    waiting.join();
    EXPECT_THROW(reader.frame(1), stream::ServerProblem);
}

// While one thread waits for what the server does not send, others take what is here: of a source, and frames with
// other parts than before, which are read and decoded anew.
TEST_F(HttpTest, NobodyWaitsForAServerButWhoNeedsIt) {
    stream::Reader reader(address("gate"));
    stream::HttpSource source(address("gate"), {});
    source.read(0, 1000);
    reader.frame(0);
    const auto gated = [&] {
        const std::string text = read_text(log);
        size_t count = 0;
        for (size_t at = text.find("gate is shut"); at != std::string::npos; at = text.find("gate is shut", at + 1))
            ++count;
        return count;
    };
    std::thread of_reader([&] { EXPECT_THROW(reader.frame(2), stream::ServerProblem); });
    std::thread of_source([&] { EXPECT_THROW(source.read(source.size() - 10, 10), stream::ServerProblem); });
    ASSERT_TRUE(server->until([&] { return gated() >= 2; })) << read_text(log);
    std::future<void> reading = std::async(std::launch::async, [&] {
        for (int i = 0; i < 200; ++i) source.read(0, 1000);
        for (const stream::Part last : {stream::kCoarse, stream::kShCoarse, stream::kFine}) reader.frame(0, last);
    });
    // Less than the time after which the server counts as stalled.
    EXPECT_EQ(reading.wait_for(std::chrono::seconds(10)), std::future_status::ready);
    reader.cancel();
    source.cancel();
    of_reader.join();
    of_source.join();
}

// A server that always sends a little, so that no pause is long.
TEST_F(HttpTest, AServerThatDripsIsNotWaitedForForEver) {
    try {
        stream::HttpSource source(address("drip"), {}, 0.3);
        FAIL() << "it never sends a whole block";
    } catch (const stream::ServerProblem& problem) {
        EXPECT_NE(std::string(problem.what()).find("sends less than"), std::string::npos) << problem.what();
    }
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
    expect_refused("more", "sends more than it was asked for");
    expect_refused("changed", "was changed");
    expect_refused("damaged", "damaged");
    server.reset();
    expect_input_error([] { stream::Reader reader("http://127.0.0.1:9/show.nvs"); },
                       {"127.0.0.1:9", "cannot be read: no server answers there"});
}

}  // namespace
}  // namespace neuvv::test::http_test
