// Sounds as they reach the ears: OpenAL writes them into a file here.
#include "editor/sound_player.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

#include "media/sound.h"
#include "stream/served_stream.h"
#include "support/temporary_folder.h"
#include "support/wav_file.h"

namespace neuvv::test::sound_player_test {
namespace {

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
            << "[general]\nfrequency = 48000\nchannels = stereo\n[wave]\nfile = " << heard.string() << "\n";
        setenv("ALSOFT_CONF", (of_openal().path / "alsoft.conf").c_str(), 1);
        setenv("ALSOFT_DRIVERS", "wave", 1);
        write_wav(folder.path / "tone.wav", stereo_tone(4 * media::kSoundRate), 2, media::kSoundRate);
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
    // Follows a clock for so long, from a stage time on.
    void follow(editor::SoundPlayer& player, double begin_s, double seconds, double speed) {
        for (double t = 0; t < seconds; t += 0.016) {
            evaluated.time_s = begin_s + t * speed;
            player.follow(stage, evaluated, speed, glm::mat4(1));
            std::this_thread::sleep_for(std::chrono::milliseconds(16));
        }
    }
};

double loudness(const media::Sound& sound, size_t side, size_t from, size_t to) {
    double sum = 0;
    for (size_t i = from; i < to; ++i) sum += std::pow(sound.samples[i][side] / 32768.0, 2);
    return std::sqrt(sum / static_cast<double>(to - from));
}

// The loudest 20 ms of both sides together.
double loudest(const media::Sound& sound) {
    constexpr size_t kPart = media::kSoundRate / 50;
    double most = 0;
    for (size_t i = 0; i + kPart < sound.samples.size(); i += kPart)
        most = std::max(most, std::hypot(loudness(sound, 0, i, i + kPart), loudness(sound, 1, i, i + kPart)));
    return most;
}

TEST_F(SoundPlayerTest, APerformerFourTimesAsFarAwayIsAQuarterAsLoud) {
    const auto loudest_at = [&](double x_m) {
        evaluated.performers.resize(1);
        evaluated.performers[0].world_from_performer[3] = glm::dvec4(x_m, 0, 0, 1);
        {
            editor::SoundPlayer player;
            follow(player, 0, 0.5, 1);
        }
        return loudest(media::read_sound(heard));
    };
    const double near = loudest_at(2);
    EXPECT_GT(near, 0.05);
    EXPECT_NEAR(loudest_at(8) / near, 0.25, 0.03);
}

TEST_F(SoundPlayerTest, AVolumeOfAQuarterIsAQuarterAsLoud) {
    evaluated.performers.resize(1);
    const auto loudest_with = [&](double volume) {
        {
            editor::SoundPlayer player;
            player.set_volume(volume);
            follow(player, 0, 0.5, 1);
        }
        return loudest(media::read_sound(heard));
    };
    const double full = loudest_with(1);
    EXPECT_GT(full, 0.05);
    EXPECT_NEAR(loudest_with(0.25) / full, 0.25, 0.03);
}

TEST_F(SoundPlayerTest, AServerThatDoesNotAnswerSilencesNobodyElse) {
    ServedStream served;
    served.start(3);
    write_wav(served.folder.path / "long.wav", stereo_tone(8 * media::kSoundRate), 2, media::kSoundRate);
    stage->performers[1].sound = fmt::format("http://127.0.0.1:{}/gate/long.wav", served.port);
    {
        editor::SoundPlayer player;
        follow(player, 0, 0.5, 1);
        EXPECT_EQ(player.take_problem(), "");
    }
    EXPECT_GT(loudest(media::read_sound(heard)), 0.05);
}

TEST_F(SoundPlayerTest, APerformerIsHeardFromWhereItIsWhileTheClockRuns) {
    {
        editor::SoundPlayer player;
        follow(player, 0, 1.2, 1);
        follow(player, 1.2, 0.6, 0);
        EXPECT_NE(player.take_problem().find("none.wav"), std::string::npos);
        EXPECT_EQ(player.take_problem(), "") << "it is told once";
    }
    const media::Sound sound = media::read_sound(heard);
    constexpr size_t kRate = media::kSoundRate, kPart = kRate / 50;
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
    EXPECT_EQ(std::count_if(last, right.end(), is_heard), 0) << "nothing after the clock stopped";
    EXPECT_GT(right_sum, 1.3 * left_sum);
}

}  // namespace
}  // namespace neuvv::test::sound_player_test
