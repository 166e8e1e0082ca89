// Sounds as they reach the ears: OpenAL writes them into a file here.
#include "editor/sound_player.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <thread>

#include "base/seconds.h"
#include "media/sound.h"
#include "stream/served_stream.h"
#include "support/temporary_folder.h"
#include "support/wav_file.h"

namespace neuvv::test::sound_player_test {
namespace {

constexpr size_t kPart = media::kSoundRate / 50;  // 20 ms

double loudness(const media::Sound& sound, size_t side, size_t from, size_t to) {
    double sum = 0;
    for (size_t i = from; i < to; ++i) sum += std::pow(sound.samples[i][side] / 32768.0, 2);
    return std::sqrt(sum / static_cast<double>(to - from));
}

// How loud both sides together are, part by part.
std::vector<double> loudness_of_parts(const media::Sound& sound) {
    std::vector<double> parts;
    for (size_t i = 0; i + kPart < sound.samples.size(); i += kPart)
        parts.push_back(std::hypot(loudness(sound, 0, i, i + kPart), loudness(sound, 1, i, i + kPart)));
    return parts;
}

double loudest(const media::Sound& sound) {
    const std::vector<double> parts = loudness_of_parts(sound);
    return parts.empty() ? 0 : *std::ranges::max_element(parts);
}

struct SoundPlayerTest : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path heard = of_openal().path / "heard.wav";
    std::shared_ptr<stage::Stage> stage = std::make_shared<stage::Stage>();
    stage::EvaluatedStage evaluated;

    // OpenAL reads its settings once.
    static const TemporaryFolder& of_openal() {
        static const TemporaryFolder made;
        return made;
    }
    void SetUp() override {
        std::ofstream(of_openal().path / "alsoft.conf")
            << "[general]\nfrequency = 48000\nchannels = stereo\nsample-type = int16\n[wave]\nfile = " << heard.string()
            << "\n";
        setenv("ALSOFT_CONF", (of_openal().path / "alsoft.conf").c_str(), 1);
        setenv("ALSOFT_DRIVERS", "wave", 1);
        write_wav(folder.path / "tone.wav", stereo_tone(20 * media::kSoundRate), 2, media::kSoundRate);
        stage::StagePerformer& performer = stage->performers.emplace_back();
        performer.settings.sound = stage::PerformerSound{"tone.wav", 0};
        performer.sound = folder.path / "tone.wav";
        performer.timeline = stage::timeline_of({}, 100, 25, "", "");
        stage::EvaluatedPerformer& shown = evaluated.performers.emplace_back();
        shown.visible = true;
        shown.world_from_performer[3] = glm::vec4(2, 0, 0, 1);  // to the right of an ear that looks along -Z
        stage->performers.push_back(performer);
        stage->performers[1].sound = folder.path / "none.wav";
        evaluated.performers.push_back(shown);
        evaluated.performers[1].performer = 1;
    }
    // What the device has played so far: its file has a header of 68 bytes, and sizes once it is closed.
    media::Sound heard_so_far() const {
        constexpr size_t kHeader = 68;
        media::Sound sound;
        std::ifstream file(heard, std::ios::binary);
        file.seekg(kHeader);
        for (media::StereoSample16 sample; file.read(reinterpret_cast<char*>(&sample), sizeof sample);)
            sound.samples.push_back(sample);
        return sound;
    }
    // Follows a clock from a stage time on, until `done`; a minute at most.
    void follow(editor::SoundPlayer& player, double begin_s, double speed, const std::function<bool()>& done) {
        const double from_s = seconds_now();
        for (double t = 0; t < 60; t = seconds_now() - from_s) {
            evaluated.time_s = begin_s + t * speed;
            player.follow(stage, evaluated, speed, glm::mat4(1));
            if (done()) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(16));
        }
        ADD_FAILURE() << "waited in vain for what is heard";
    }
    // Whether so many parts are louder than nothing.
    bool has_heard(int64_t count) const {
        return std::ranges::count_if(loudness_of_parts(heard_so_far()), [](double loud) { return loud > 0.004; }) >=
               count;
    }
    // How loud a player is that plays from the beginning of the stage.
    double loudest_of(double volume = 1) {
        std::filesystem::remove(heard);
        {
            editor::SoundPlayer player;
            player.set_volume(volume);
            follow(player, 0, 1, [&] { return has_heard(15); });
        }
        return loudest(media::read_sound(heard));
    }
};

TEST_F(SoundPlayerTest, APerformerFourTimesAsFarAwayIsAQuarterAsLoud) {
    const auto loudest_at = [&](double x_m) {
        evaluated.performers.resize(1);
        evaluated.performers[0].world_from_performer[3] = glm::dvec4(x_m, 0, 0, 1);
        return loudest_of();
    };
    const double near = loudest_at(2);
    EXPECT_GT(near, 0.05);
    EXPECT_NEAR(loudest_at(8) / near, 0.25, 0.03);
}

TEST_F(SoundPlayerTest, AVolumeOfAQuarterIsAQuarterAsLoud) {
    evaluated.performers.resize(1);
    const double full = loudest_of(1);
    EXPECT_GT(full, 0.05);
    EXPECT_NEAR(loudest_of(0.25) / full, 0.25, 0.03);
}

TEST_F(SoundPlayerTest, AServerThatDoesNotAnswerSilencesNobodyElse) {
    ServedStream served;
    served.start(3);
    write_wav(served.folder.path / "long.wav", stereo_tone(8 * media::kSoundRate), 2, media::kSoundRate);
    stage->performers[1].sound = fmt::format("http://127.0.0.1:{}/gate/long.wav", served.port);
    std::filesystem::remove(heard);
    {
        editor::SoundPlayer player;
        follow(player, 0, 1, [&] { return has_heard(15); });
        EXPECT_EQ(player.take_problem(), "");
    }
    EXPECT_GT(loudest(media::read_sound(heard)), 0.05);
}

TEST_F(SoundPlayerTest, APerformerIsHeardFromWhereItIsWhileTheClockRuns) {
    std::filesystem::remove(heard);
    std::string problem;
    {
        editor::SoundPlayer player;
        follow(player, 0, 1, [&] {
            if (problem.empty()) problem = player.take_problem();
            return has_heard(60) && !problem.empty();
        });
        EXPECT_NE(problem.find("none.wav"), std::string::npos) << problem;
        const size_t stopped_at = heard_so_far().samples.size();
        follow(player, evaluated.time_s, 0, [&] { return heard_so_far().samples.size() > stopped_at + 30 * kPart; });
        EXPECT_EQ(player.take_problem(), "") << "it is told once";
    }
    const media::Sound sound = media::read_sound(heard);
    std::vector<double> right;
    double left_sum = 0, right_sum = 0;
    for (size_t i = 0; i + kPart < sound.samples.size(); i += kPart) {
        right.push_back(loudness(sound, 1, i, i + kPart));
        left_sum += loudness(sound, 0, i, i + kPart);
        right_sum += right.back();
    }
    const auto is_heard = [](double loud) { return loud > 0.02; };
    const auto first = std::find_if(right.begin(), right.end(), is_heard);
    const auto last = std::find_if(right.rbegin(), right.rend(), is_heard).base();
    ASSERT_LT(first, last) << "something is heard";
    EXPECT_GT(std::count_if(first, last, is_heard), 30) << "most of 1.2 s, in parts of 20 ms";
    EXPECT_GT(right.end() - last, 20) << "nothing after the clock stopped, but for what waited in the device";
    EXPECT_GT(right_sum, 1.3 * left_sum);
}

}  // namespace
}  // namespace neuvv::test::sound_player_test
