// Sounds of performers, on the command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "media/sound.h"
#include "media/video.h"
#include "stage/evaluated_stage.h"
#include "stage/sound/pan.h"
#include "stream/served_stream.h"
#include "support/wav_file.h"
#include "tests/tools/cli_gpu.h"
#include "voctree/files/clip.h"

namespace neuvv {
namespace {

struct CliSound : CliGpu {
    std::string show = file("show.gltf"), wav = file("tone.wav"), video = file("show.mp4");

    void SetUp() override {
        CliGpu::SetUp();
        test::write_wav(wav, test::stereo_tone(2 * media::kSoundRate), 2, media::kSoundRate);
        expect_done({"stage", "new", show});
        expect_done({"stage", "add", show, scene, "--name", "anna", "--time", "loop", "--sound", wav, "--gain", "-6"});
    }
    static void expect_done(const std::vector<std::string>& call) {
        const ProgramResult run = run_neuvv(call);
        EXPECT_EQ(run.code, 0) << run.err;
    }
    void render(const std::vector<std::string>& more) {
        std::vector<std::string> call = {"render", "--overwrite", show,  "-o",    video, "--size",
                                         "32x24",  "--time",      "0:1", "--fps", "8"};
        call.insert(call.end(), more.begin(), more.end());
        expect_done(call);
    }
    // The loudest sample of a side of the video's sound, in its centre; a tone at 0 dB has 1.
    double loudest(size_t side = 0) const {
        const media::Sound sound = media::read_sound(video);
        EXPECT_NEAR(sound.length_s(), 1, 0.05);
        double most = 0;
        for (size_t i = media::kSoundRate / 4; i < media::kSoundRate * 3 / 4; ++i)
            most = std::max(most, std::abs(sound.samples[i][side] / 16000.0));
        return most;
    }
    // What this is of a performer at -6 dB, by where it is for the stage's camera.
    double expected(size_t side = 0) const {
        const stage::Stage stage = stage::load_stage(show);
        const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0);
        const glm::dmat4 camera_from_world =
            glm::inverse(stage::camera_of(stage, "", evaluated, 32, 24).world_from_camera);
        const glm::dvec3 at(camera_from_world * evaluated.performers[0].world_from_performer[3]);
        const double of_both_sides = 0.75;  // of the tone
        return of_both_sides * std::pow(10, -6.0 / 20) * double{stage::pan_gains(at)[side]};
    }
};

TEST_F(CliSound, AVideoOfAStageHasTheSoundOfItsPerformers) {
    render({});
    EXPECT_EQ(media::summarise_video(video).frames, 8u);
    EXPECT_GT(expected(), 0.1);
    EXPECT_NEAR(loudest(), expected(), 0.05 * expected());
    const ProgramResult info = run_neuvv({"stage", "info", show});
    EXPECT_NE(info.out.find("sound tone.wav at -6 dB"), std::string::npos) << info.out;
    expect_done({"stage", "add", show, scene, "--name", "berta", "--time", "loop", "--sound", wav, "--gain", "-6"});
    render({});
    EXPECT_NEAR(loudest(), 2 * expected(), 0.1 * expected()) << "both together";
    expect_done({"stage", "set", show, "berta", "--visible", "off"});
    expect_done({"stage", "set", show, "anna", "--sound", ""});
    render({});
    EXPECT_THROW(media::read_sound(video), InputError) << "nobody is heard";
}

TEST_F(CliSound, APerformerIsHeardFromItsSideOfTheCamera) {
    expect_done({"stage", "set", show, "anna", "--at", "3,0,1"});
    render({});
    EXPECT_NEAR(loudest(0), expected(0), 0.05 * expected(1));
    EXPECT_NEAR(loudest(1), expected(1), 0.05 * expected(1));
    EXPECT_GT(loudest(1), 1.5 * loudest(0));
    render({"--orbit"});  // a quarter of its turn, on which the camera comes past the performer's other side
    EXPECT_GT(std::abs(loudest(1) / loudest(0) - expected(1) / expected(0)), 0.1);
}

TEST_F(CliSound, PartsOfAVideoAreJoinedWithSound) {
    render({"--part", "1/2"});
    EXPECT_FALSE(std::filesystem::exists(video));
    render({"--part", "2/2"});
    EXPECT_EQ(media::summarise_video(video).frames, 8u);
    EXPECT_NEAR(loudest(), expected(), 0.05 * expected());
    EXPECT_FALSE(std::filesystem::exists(video + ".parts"));
    render({"--part", "2/2", "--resume"});  // finds that all is there
    EXPECT_NEAR(loudest(), expected(), 0.05 * expected());
}

// A clip's sound lies beside it, and goes where the clip goes.
TEST_F(CliSound, AClipTakesItsSoundAlong) {
    const std::string model = NEUVV_SOURCE_DIR "/tools/performer/performer.glb";
    expect_done({"capture", model, "-o", file("data"), "--cameras", "5", "--frames", "3", "--size", "32x32"});
    const std::string clip = file("sung.nvv");
    expect_refused({"train", file("data"), "-o", clip, "--steps", "1", "--audio", scene}, 2, {"cannot be opened as a"});
    EXPECT_FALSE(std::filesystem::exists(clip));
    expect_done({"train", file("data"), "-o", clip, "--steps", "2", "--resolution", "32", "--audio", wav});
    EXPECT_NEAR(media::read_sound(file("sung.m4a")).length_s(), 2, 0.05);
    expect_done({"publish", "--overwrite", clip, "-o", file("out.nvs")});
    for (const std::string& sung : {clip, file("out.nvs")}) {
        const std::string stage = file("sung.gltf");
        expect_done({"stage", "new", stage});
        expect_done({"stage", "add", stage, sung, "--name", "berta"});
        const ProgramResult info = run_neuvv({"stage", "info", stage});
        EXPECT_NE(info.out.find("sound " + std::filesystem::path(sung).stem().string() + ".m4a"), std::string::npos)
            << info.out;
        expect_done({"stage", "new", file("silent.gltf")});
        expect_done({"stage", "add", file("silent.gltf"), sung, "--name", "silent", "--sound", ""});
        const ProgramResult silent = run_neuvv({"stage", "info", file("silent.gltf")});
        EXPECT_EQ(silent.out.find("sound"), std::string::npos) << silent.out;
        std::filesystem::remove(stage);
        std::filesystem::remove(file("silent.gltf"));
    }
    const double fps = voctree::read_clip_header(clip).fps;
    const uint32_t frames = voctree::read_clip_header(clip).frames;
    expect_done({"clip", "cut", clip, "-o", file("cut.nvv"), "--from", "1", "--to", "2"});
    const media::Sound whole = media::read_sound(file("sung.m4a")), cut = media::read_sound(file("cut.m4a"));
    EXPECT_NEAR(cut.length_s(), 1 / fps, 0.03);
    expect_refused({"clip", "cut", clip, "-o", file("out.nvv"), "--to", "1"}, 2, {"out.m4a", "is there already"});
    EXPECT_FALSE(std::filesystem::exists(file("out.nvv")));
    expect_done({"train", file("data"), "-o", clip, "--steps", "1", "--resolution", "32", "--audio", file("sung.m4a"),
                 "--overwrite"});
    EXPECT_EQ(media::read_sound(file("sung.m4a")).samples, whole.samples) << "it is that file already";
    expect_done({"clip", "join", clip, file("cut.nvv"), "-o", file("joined.nvv")});
    EXPECT_NEAR(media::read_sound(file("joined.m4a")).length_s(), (frames + 1) / fps, 0.03);
}

TEST_F(CliSound, TheSoundBesideAStreamOnAServerIsItsPerformers) {
    test::ServedStream served;
    served.start(3);
    media::write_sound(served.folder.path / "show.m4a", media::read_sound(wav));
    std::filesystem::remove(show);
    expect_done({"stage", "new", show});
    expect_done({"stage", "add", show, served.address("ok"), "--name", "anna", "--time", "loop", "--gain", "-6"});
    const ProgramResult info = run_neuvv({"stage", "info", show});
    EXPECT_NE(info.out.find("/ok/show.m4a at -6 dB"), std::string::npos) << info.out;
    render({});
    EXPECT_GT(loudest(), 0.02);
    std::filesystem::remove(served.folder.path / "show.m4a");
    expect_refused({"render", show, "-o", video, "--size", "32x24", "--time", "0:1"}, 2, {"show.m4a", "404"});
}

TEST_F(CliSound, WrongSoundsAreRefused) {
    expect_refused({"stage", "set", show, "anna", "--sound", scene}, 2, {"cannot be opened as a sound"});
    expect_refused({"stage", "set", show, "anna", "--gain", "100"}, 2, {"--gain"});
    expect_done({"stage", "set", show, "anna", "--sound", ""});
    expect_refused({"stage", "set", show, "anna", "--gain", "3"}, 2, {"has no sound"});
    expect_done({"stage", "set", show, "anna", "--sound", wav});
    std::filesystem::remove(wav);
    expect_refused({"render", show, "-o", video, "--size", "32x24", "--time", "0:1"}, 2, {"tone.wav"});
}

}  // namespace
}  // namespace neuvv
