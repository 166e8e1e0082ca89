// Tests of the export of videos, by its panel.
#include "base/error.h"
#include "media/sound.h"
#include "media/video.h"
#include "support/wav_file.h"
#include "viewer_window/viewer_window.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Exporting : ViewerWindow {
    static void set(Hands& hands, const std::string& field, const std::string& value) {
        hands.double_click(hands.centre_of(field));
        hands.key("ctrl+a");
        hands.type(value);
        hands.key("Return");
    }
    void export_to(Hands& hands, const std::string& name) const {
        hands.wheel(hands.centre_of("export/Width"), -30);  // to the end of the panel
        hands.click("export/start");
        hands.centre_of("question/name");
        hands.type(name);
        hands.key("Return");
        hands.until_notice("exported " + file(name.c_str()));
    }
};

TEST_F(Exporting, AVideoHasTheSoundsThatTheWindowPlays) {
    write_wav(file("tone.wav"), stereo_tone(2 * media::kSoundRate), 2, media::kSoundRate);
    done({"stage", "set", stage, "anna", "--sound", file("tone.wav")});
    const auto hands = open(stage, "720x780");
    hands->until_rest();
    hands->click("tab/render");
    set(*hands, "export/Width", "64");
    set(*hands, "export/Height", "48");
    export_to(*hands, "sung.mp4");
    EXPECT_EQ(media::summarise_video(file("sung.mp4")).frames, 8u);
    EXPECT_NEAR(media::read_sound(file("sung.mp4")).length_s(), 2, 0.05);
    hands->click("stage/anna/sound");
    hands->until("anna to be muted", [](const json& now) { return now["muted"].size() == 1; });
    export_to(*hands, "silent.mp4");
    EXPECT_EQ(media::summarise_video(file("silent.mp4")).frames, 8u);
    EXPECT_THROW(media::read_sound(file("silent.mp4")), InputError);
}

// The menu publishes the clip that is open, by `neuvv publish` itself, and the stream can be watched at once.
TEST_F(Exporting, AClipIsPublishedFromTheMenuAndWatched) {
    const auto hands = open(clip, "900x700");
    EXPECT_EQ(hands->until_rest()["title"], "waver.nvv – NeuVV");
    hands->click("menu/File");
    hands->click("menu/publish");
    hands->click("verb/start");
    const json report =
        hands->until("the verb to end", [](const json& now) { return now["verb"]["code"].is_number(); });
    EXPECT_EQ(report["verb"]["code"], 0);
    EXPECT_TRUE(std::filesystem::exists(file("waver.nvs")));
    hands->click("verb/watch");
    hands->until("the stream", [](const json& now) { return now["title"] == "waver.nvs – NeuVV"; });
    hands->click("verb/close");
    EXPECT_FALSE(hands->until_rest()["verb"]["open"].get<bool>());
}

// Hours of work may end with the window.
TEST_F(Exporting, AVerbThatRunsIsAskedAboutBeforeTheWindowCloses) {
    voctree::VOctree tree = waver_tree();
    tree.frames *= 1000;
    for (std::vector<float>* basis : {&tree.sigma_basis, &tree.gamma_basis}) {
        const std::vector<float> once = *basis;
        for (int i = 1; i < 1000; ++i) basis->insert(basis->end(), once.begin(), once.end());
    }
    voctree::write_nvv(clip, tree);
    const auto hands = open(clip, "900x700");
    hands->until_rest();
    hands->click("menu/File");
    hands->click("menu/publish");
    hands->click("verb/start");
    const auto quit = [&] {
        hands->click("menu/File");
        hands->click("menu/Quit");
    };
    quit();
    hands->click("question/Cancel");
    hands->until("the verb to run on", [](const json& now) { return now["verb"]["running"] == true; });
    quit();
    hands->click("question/Stop");
    EXPECT_EQ(hands->wait_for_end(), 0);
    EXPECT_FALSE(std::filesystem::exists(file("waver.nvs")));
}

}  // namespace
}  // namespace neuvv::test
