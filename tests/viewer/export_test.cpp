// What the viewer exports: the sound of its videos.
#include "tools/viewer/verbs/export.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "edit/operations.h"
#include "media/sound.h"
#include "media/video.h"
#include "stage/sound/pan.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "support/wav_file.h"
#include "voctree/files/nvv.h"

namespace neuvv::test::export_test {
namespace {

constexpr size_t kRate = media::kSoundRate;
constexpr glm::dvec3 kPerformer{0, -0.5, -3};  // in the camera's frame

// A stage of two seconds with anna and berta, who are heard in its second second.
struct ExportTest : GpuTest {
    TemporaryFolder folder;
    editor::RenderThread thread{device(), [] {}};
    std::shared_ptr<const stage::Stage> stage;

    void SetUp() override {
        voctree::VOctree tree = random_tree({.leaves = 200, .frames = 4});
        tree.fps = 2;
        voctree::write_nvv(folder.path / "clip.nvv", tree);
        std::vector<int16_t> late(2 * kRate);
        const std::vector<int16_t> tone = stereo_tone(kRate);
        late.insert(late.end(), tone.begin(), tone.end());
        write_wav(folder.path / "late.wav", late, 2, kRate);
        edit::Document document;
        document.file = edit::new_stage(folder.path / "show.gltf");
        edit::PerformerEdit performer;
        performer.clip = folder.path / "clip.nvv";
        performer.sound = folder.path / "late.wav";
        performer.gain_db = -12;
        for (const char* name : {"anna", "berta"}) edit::add_performer(document.file, name, performer, {});
        stage = std::make_shared<const stage::Stage>(stage::make_stage(document.file));
        thread.show(std::make_shared<const edit::Document>(std::move(document)), 1);
    }
    // The settings of a video of half a second from `first_s` on.
    viewer::ExportSettings settings(const char* file, double first_s) const {
        viewer::ExportSettings settings;
        settings.output = media::parse_output((folder.path / file).string());
        settings.size = {32, 24};
        settings.fps = 8;
        settings.first_s = first_s;
        settings.images = 4;
        settings.samples = 1;
        settings.camera = [](const stage::Stage&, const stage::EvaluatedStage&) {
            return look_at({0, 0.5, 3}, {0, 0.5, 0}, 32, 24, 1);
        };
        settings.heard_stage = stage;
        return settings;
    }
    static bool wait_for(const std::function<bool()>& reached) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
        while (!reached() && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return reached();
    }
    std::shared_ptr<viewer::Export> begin(const viewer::ExportSettings& settings) {
        auto job = std::make_shared<viewer::Export>(settings);
        thread.post_idle([job](editor::OnDevice& on_device) { return job->step(on_device); });
        return job;
    }
    viewer::Export::End exported(const viewer::ExportSettings& settings) {
        const auto job = begin(settings);
        EXPECT_TRUE(wait_for([&] { return job->end().has_value(); }));
        return job->end().value_or(viewer::Export::End{});
    }
    // The loudest sample of the video's centre, where 1 is as loud as one performer is for the camera.
    double loudest(const char* file) const {
        const media::Sound sound = media::read_sound(folder.path / file);
        EXPECT_NEAR(sound.length_s(), 0.5, 0.05);
        double most = 0;
        for (size_t i = kRate / 8; i < 3 * kRate / 8; ++i) most = std::max(most, std::abs(sound.samples[i][0] / 1.0));
        const double of_both_sides = 0.75;  // of the tone
        return most / (of_both_sides * 16000 * std::pow(10, -12.0 / 20) * double{stage::pan_gains(kPerformer)[0]});
    }
};

TEST_F(ExportTest, AVideoIsHeardAsItsTimeOfTheStageIs) {
    viewer::Export::End end = exported(settings("later.mp4", 1));
    EXPECT_FALSE(end.error) << end.text;
    EXPECT_EQ(media::summarise_video(folder.path / "later.mp4").frames, 4u);
    EXPECT_NEAR(loudest("later.mp4"), 2, 0.2);
    end = exported(settings("earlier.mp4", 0));
    EXPECT_FALSE(end.error) << end.text;
    EXPECT_LT(loudest("earlier.mp4"), 0.01);
}

TEST_F(ExportTest, WhoIsMutedInTheWindowIsNotInTheVideo) {
    viewer::ExportSettings of_one = settings("one.mp4", 1);
    of_one.is_heard = [](uint32_t performer) { return performer == 1; };
    viewer::Export::End end = exported(of_one);
    EXPECT_FALSE(end.error) << end.text;
    EXPECT_NEAR(loudest("one.mp4"), 1, 0.1);
    viewer::ExportSettings of_nobody = settings("none.mp4", 1);
    of_nobody.is_heard = [](uint32_t) { return false; };
    end = exported(of_nobody);
    EXPECT_FALSE(end.error) << end.text;
    EXPECT_EQ(media::summarise_video(folder.path / "none.mp4").frames, 4u);
    EXPECT_THROW(media::read_sound(folder.path / "none.mp4"), InputError);
}

TEST_F(ExportTest, ASoundThatCannotBeReadIsAnErrorOfVideosAlone) {
    std::ofstream(folder.path / "late.wav") << "no sound at all";
    const viewer::Export::End video = exported(settings("video.mp4", 1));
    EXPECT_TRUE(video.error);
    EXPECT_NE(video.text.find("late.wav"), std::string::npos) << video.text;
    const viewer::Export::End images = exported(settings("image_%04d.png", 1));
    EXPECT_FALSE(images.error) << images.text;
    EXPECT_TRUE(std::filesystem::exists(folder.path / "image_0003.png"));
}

TEST_F(ExportTest, NothingRemainsOfAVideoThatIsCancelledBeforeItsSoundIsThere) {
    std::atomic<bool> reads_on = false;
    viewer::ExportSettings chosen = settings("cancelled.mp4", 1);
    chosen.is_heard = [&](uint32_t) { return wait_for([&] { return reads_on.load(); }); };
    const auto job = begin(chosen);
    EXPECT_TRUE(wait_for([&] { return job->finished_images() == 4; }));
    EXPECT_TRUE(std::filesystem::exists(folder.path / "cancelled.mp4"));
    EXPECT_FALSE(job->end());
    job->cancel();
    reads_on = true;
    EXPECT_TRUE(wait_for([&] { return job->end().has_value(); }));
    EXPECT_FALSE(job->end()->error) << job->end()->text;
    EXPECT_NE(job->end()->text.find("export cancelled"), std::string::npos) << job->end()->text;
    EXPECT_FALSE(std::filesystem::exists(folder.path / "cancelled.mp4"));
}

}  // namespace
}  // namespace neuvv::test::export_test
