// The sound beside a stream on a server.
#include <gtest/gtest.h>

#include "media/sound.h"
#include "stream/served_stream.h"
#include "support/wav_file.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::test::served_sound_test {
namespace {

struct ServedSound : testing::Test, ServedStream {
    void SetUp() override { start(3); }
    std::string sound_address(const std::string& mode) const {
        return fmt::format("http://127.0.0.1:{}/{}/show.m4a", port, mode);
    }
    void write_sound() const {
        media::Sound sound;
        for (const int16_t value : stereo_tone(media::kSoundRate / 2)) sound.samples.push_back({value, value});
        media::write_sound(folder.path / "show.m4a", sound);
    }
};

TEST_F(ServedSound, IsFoundBesideAStreamAndRead) {
    EXPECT_FALSE(voctree::sound_beside(address("ok"))) << "there is none";
    std::ofstream(folder.path / "show.m4a") << "<html>This page is not there.</html>";
    EXPECT_FALSE(voctree::sound_beside(address("page"))) << "it is no sound";
    write_sound();
    EXPECT_EQ(voctree::sound_beside(address("ok")), sound_address("ok"));
    EXPECT_EQ(voctree::sound_beside(address("ok") + "?key=a.b/c"), sound_address("ok") + "?key=a.b/c");
    EXPECT_FALSE(voctree::sound_beside(address("missing")));
    EXPECT_EQ(media::read_sound(voctree::sound_here(sound_address("ok"))).samples,
              media::read_sound(folder.path / "show.m4a").samples);
    server.reset();
    EXPECT_THROW(voctree::sound_beside(address("ok")), stream::ServerProblem);
}

TEST(SoundsOnServers, AreLookedForBesideStreamsAlone) {
    for (const char* other :
         {"http://127.0.0.1:1/clip", "http://127.0.0.1:1", "http://host.nvs", "https://host/a.nvs/"})
        EXPECT_FALSE(voctree::sound_beside(other))
            << other << ": else the server would be asked, which does not answer";
}

}  // namespace
}  // namespace neuvv::test::served_sound_test
