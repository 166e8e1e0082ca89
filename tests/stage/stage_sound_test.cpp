// What is heard of a stage in a video: each performer from where it is, for the ears of a camera.
#include "stage/sound/stage_sound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stage/evaluated_stage.h"
#include "support/wav_file.h"
#include "tests/stage/stage_files.h"

namespace neuvv::test::stage_sound_test {
namespace {

constexpr size_t kRate = media::kSoundRate, kHop = media::kSoundHop;

// A stage with one performer at (1, 0, 0), who is heard from its beginning on.
struct StageSoundTest : testing::Test {
    TemporaryFolder folder;
    stage::Stage stage;

    void SetUp() override {
        put_clip(folder.path / "anna.nvv", 50);
        write_wav(folder.path / "tone.wav", stereo_tone(2 * kRate), 2, kRate);
        stage = stage_with("");
    }
    // `more` are further members of the glTF file.
    stage::Stage stage_with(const std::string& more) const {
        return stage::make_stage(stage::make_stage_file(folder.path / "show.gltf", R"({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "extensionsUsed": ["NEUVV_performer"],
            "nodes": [{"name": "anna", "translation": [1, 0, 0],
                       "extensions": {"NEUVV_performer": {"uri": "anna.nvv", "sound": {"uri": "tone.wav"}}}}])" +
                                                                                       more + "}"));
    }
    std::vector<media::StereoSample> heard(const stage::StageSound::EarAt& ear_at, double seconds) const {
        stage::StageSound sound(stage, 0, ear_at);
        std::vector<media::StereoSample> all;
        while (all.size() < static_cast<size_t>(seconds * kRate)) {
            std::array<media::StereoSample, kHop> samples{};
            sound.next(samples);
            all.insert(all.end(), samples.begin(), samples.end());
        }
        return all;
    }
};

// An ear that is so far to the right, and looks along −Z.
glm::dmat4 ear_at_x(double x) {
    glm::dmat4 ear(1);
    ear[3].x = x;
    return ear;
}

float loudest(const std::vector<media::StereoSample>& samples, size_t side, double from_s, double to_s) {
    float most = 0;
    for (auto i = static_cast<size_t>(from_s * kRate); i < static_cast<size_t>(to_s * kRate); ++i)
        most = std::max(most, std::abs(samples[i][side]));
    return most;
}

float steepest(const std::vector<media::StereoSample>& samples, size_t side) {
    float most = 0;
    for (size_t i = kRate / 10; i < samples.size(); ++i)
        most = std::max(most, std::abs(samples[i][side] - samples[i - 1][side]));
    return most;
}

constexpr float kTone = 0.75f * 16000 / 32768;  // both sides of it together, halved

TEST_F(StageSoundTest, APerformerIsHeardFromItsSideOfTheCamera) {
    const auto of_left = heard([](const stage::EvaluatedStage&) { return ear_at_x(0); }, 0.5);
    EXPECT_NEAR(loudest(of_left, 0, 0.1, 0.4), 0, 1e-3) << "it is to the right of the ear";
    EXPECT_NEAR(loudest(of_left, 1, 0.1, 0.4), kTone, 0.01f * kTone);
    const auto of_right = heard([](const stage::EvaluatedStage&) { return ear_at_x(5); }, 0.5);
    EXPECT_NEAR(loudest(of_right, 0, 0.1, 0.4), kTone / 2, 0.01f * kTone) << "it is four metres to the left of the ear";
    EXPECT_NEAR(loudest(of_right, 1, 0.1, 0.4), 0, 1e-3);
}

TEST_F(StageSoundTest, AnEarThatMovesIsFollowedWithoutClicks) {
    const float of_tone =
        kTone * static_cast<float>(2 * std::numbers::pi * 440 / kRate);  // the most from sample to sample
    const auto moving = heard([](const stage::EvaluatedStage& now) { return ear_at_x(2 * now.time_s); }, 1);
    EXPECT_GT(loudest(moving, 1, 0.1, 0.2), 4 * loudest(moving, 0, 0.1, 0.2));
    EXPECT_GT(loudest(moving, 0, 0.8, 0.9), 4 * loudest(moving, 1, 0.8, 0.9)) << "it has passed the performer";
    const auto jumping = heard([](const stage::EvaluatedStage& now) { return ear_at_x(now.time_s < 0.5 ? 0 : 2); }, 1);
    EXPECT_NEAR(loudest(jumping, 0, 0.6, 0.9), kTone, 0.01f * kTone);
    EXPECT_NEAR(loudest(jumping, 1, 0.6, 0.9), 0, 1e-3);
    for (const auto* samples : {&moving, &jumping})
        for (const size_t side : {0, 1}) EXPECT_LT(steepest(*samples, side), 1.1f * of_tone);
}

// The animation moves it from (-2, 0, 0) to (2, 0, 0) within a second.
TEST_F(StageSoundTest, APerformerThatMovesIsFollowed) {
    stage = stage_with(R"(, "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                                            "samplers": [{"input": 0, "output": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
                      {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 8}, {"buffer": 0, "byteOffset": 8, "byteLength": 24}],
        "buffers": [{"byteLength": 32, "uri": "data:application/octet-stream;base64,AAAAAAAAgD8AAADAAAAAAAAAAAAAAABAAAAAAAAAAAA="}])");
    const auto moving = heard([](const stage::EvaluatedStage&) { return ear_at_x(0); }, 1);
    EXPECT_GT(loudest(moving, 0, 0.1, 0.3), 4 * loudest(moving, 1, 0.1, 0.3));
    EXPECT_GT(loudest(moving, 1, 0.7, 0.9), 4 * loudest(moving, 0, 0.7, 0.9));
}

TEST_F(StageSoundTest, WhoIsHiddenOrNotToBeHeardIsSilent) {
    const auto ear_at = [](const stage::EvaluatedStage&) { return ear_at_x(0); };
    EXPECT_FALSE(stage::StageSound(stage, 0, ear_at).is_silent());
    EXPECT_TRUE(stage::StageSound(stage, 0, ear_at, [](uint32_t) { return false; }).is_silent());
    stage.performers[0].settings.visible = false;
    EXPECT_TRUE(stage::StageSound(stage, 0, ear_at).is_silent());
}

}  // namespace
}  // namespace neuvv::test::stage_sound_test
