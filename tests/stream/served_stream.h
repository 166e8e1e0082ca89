// A stream and a server that serves it, well or badly (http_server.py).
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "stream/random_slice.h"
#include "stream/transport/http_source.h"
#include "stream/transport/nvs_reader.h"
#include "stream/transport/nvs_writer.h"
#include "support/child_process.h"
#include "support/temporary_folder.h"

namespace neuvv::test {

struct ServedStream {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "show.nvs", log = folder.path / "server.log";
    std::vector<stream::QuantisedSlice> decoded;  // the frames, by the encoder
    std::unique_ptr<ChildProcess> server;
    int port = 0;

    // What comes from the server is kept here.
    ServedStream() { setenv("XDG_CACHE_HOME", (folder.path / "cache").c_str(), 1); }
    // Groups of one frame, each of about a block.
    void write(uint32_t frames) {
        stream::Steps steps;
        steps.fill(6);
        stream::Writer writer(file, 25, frames, frames);
        for (uint32_t i = 0; i < frames; ++i) {
            std::vector<stream::FrameSymbols> one;
            one.push_back(stream::encode(random_slice(i + 1, 8, 20'000, 1), steps, {}, decoded.emplace_back()));
            stream::Group group;
            group.format = {8, 1, 100'000};
            writer.add(group, one);
        }
        EXPECT_GT(writer.finish(), 2 * stream::HttpSource::kBlock) << "else it is no test of blocks";
    }
    // Writes the stream, and serves it.
    void start(uint32_t frames) {
        write(frames);
        server = std::make_unique<ChildProcess>(
            std::vector<std::string>{"/usr/bin/env", "python3", NEUVV_SOURCE_DIR "/tests/stream/http_server.py",
                                     folder.path.string()},
            log);
        ASSERT_TRUE(server->until([&] { return bool(std::ifstream(log) >> port) && port != 0; }))
            << "is python3 there?";
    }
    std::string address(const std::string& mode) const {
        return fmt::format("http://127.0.0.1:{}/{}/show.nvs", port, mode);
    }
};

}  // namespace neuvv::test
