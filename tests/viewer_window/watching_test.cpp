// Tests of watching: opening, playing, looking around, and the window itself.
#include <fstream>

#include "media/sound.h"
#include "support/wav_file.h"
#include "viewer_window/viewer_window.h"

namespace neuvv::test {
namespace {

using nlohmann::json;
using Watching = ViewerWindow;
constexpr double kFps = 4;  // of the waver

TEST(ViewerWindowComparison, TellsImagesApart) {
    media::Image plain(40, 30), marked = plain;
    std::fill(plain.rgba.begin(), plain.rgba.end(), uint8_t{100});
    marked = plain;
    EXPECT_TRUE(same(plain, marked));
    for (uint32_t x = 0; x < 7; ++x) marked.at(x, 5)[1] = 120;
    EXPECT_TRUE(other(plain, marked));
    EXPECT_FALSE(same(plain, marked));
    EXPECT_FALSE(same(plain, media::Image(30, 40)));
    EXPECT_FALSE(other(plain, media::Image(30, 40)));
}

TEST_F(Watching, TheWindowShowsWhatRenderDraws) {
    const auto hands = open(stage);
    hands->until_rest();
    const media::Image shown = hands->image();
    hands->until_notice("saved " + folder.path.string());
    EXPECT_TRUE(same(shown, rendered(shown)));
    EXPECT_TRUE(other(shown, rendered(shown, {"--time", "1.5"}))) << "another instant would be seen";

    for (const char* shown_over_it : {"menu/Axes", "menu/Statistics"}) {
        hands->click("menu/View");
        hands->click(shown_over_it);
    }
    hands->key("Escape");
    hands->point(hands->in_image(0.5, 0.9));
    const media::Image window = hands->window();
    EXPECT_EQ(window.width, 640u);
    EXPECT_EQ(window.height, 400u);
    const std::vector<double> at = hands->seen()["items"]["image"];
    const uint32_t tools = 110;                                // the width of the toolbar, in two columns
    media::Image part(shown.width - tools, shown.height / 2);  // above the notices
    media::Image above(part.width, part.height);
    for (uint32_t y = 0; y < part.height; ++y)
        for (uint32_t x = 0; x < part.width; ++x) {
            const auto left = static_cast<uint32_t>(at[0]), top = static_cast<uint32_t>(at[1]);
            std::copy_n(window.at(left + tools + x, top + y), 4, part.at(x, y));
            std::copy_n(shown.at(tools + x, y), 4, above.at(x, y));
        }
    EXPECT_LE(share_that_differs(part, above, 0), 0.05) << "the same pixels, but for handles and signs";
}

TEST_F(Watching, AClipOpensAsAStageOfItsOwn) {
    const auto hands = open(clip);
    const json report = hands->until_rest();
    EXPECT_EQ(report["open"], file("waver.gltf"));
    EXPECT_EQ(report["modified"], false);
    const media::Image person = hands->image();
    const uint8_t* corner = person.at(2, 2);
    size_t seen = 0;
    for (size_t i = 0; i < person.rgba.size(); i += 4) seen += std::abs(person.rgba[i] - corner[0]) > kSteps;
    EXPECT_GT(seen, person.rgba.size() / 4 / 50) << "somebody stands there";
    const uint8_t* floor = person.at(2, person.height - 3);
    EXPECT_GT(floor[0], corner[0] + 20) << "on a lit floor";
}

TEST_F(Watching, WhatIsNotShownOfAStageIsSaid) {
    json two = saved();
    two["scenes"].push_back(json::object());
    write_text(stage, two.dump());
    open(stage)->until_notice("show.gltf shows its scene 0 alone; it has 2");
}

TEST_F(Watching, PlaysAndPauses) {
    const auto hands = open(stage);
    hands->until_rest();
    const media::Image first = hands->image();
    hands->key("space");
    hands->until("time to go on", [](const json& now) { return now["playing"] == true && now["time_s"] > 0.3; });
    hands->key("space");
    const double paused_s = hands->until_rest()["time_s"];
    const media::Image later = hands->image();
    const json still = hands->until_rest();
    EXPECT_EQ(still["playing"], false);
    EXPECT_EQ(still["time_s"], paused_s);
    EXPECT_TRUE(same(later, rendered(later, {"--time", std::to_string(paused_s)}))) << paused_s;
    EXPECT_TRUE(other(first, rendered(first, {"--time", "1.5"}))) << "time is seen";

    hands->key("period");
    const double stepped_s = hands->until_rest()["time_s"];
    EXPECT_NEAR(stepped_s * kFps, std::round(stepped_s * kFps), 1e-6) << "on an image";
    EXPECT_NE(stepped_s, paused_s);
}

// The sum of red, green and blue of the window's pixel.
int brightness_at(const media::Image& window, double x, double y) {
    const uint8_t* pixel = window.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y));
    return pixel[0] + pixel[1] + pixel[2];
}

TEST_F(Watching, ASoundIsSeenOnTheTimelineWhereItIsHeard) {
    const std::vector<int16_t> tone = stereo_tone(media::kSoundRate);
    std::vector<int16_t> samples(tone.size());  // silence in the first second
    samples.insert(samples.end(), tone.begin(), tone.end());
    write_wav(file("late.wav"), samples, 2, media::kSoundRate);
    done({"stage", "set", stage, "anna", "--sound", file("late.wav")});
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    hands->centre_of("timeline/anna/waveform");
    const json items = hands->seen()["items"];
    const std::vector<double> start = items["timeline/anna/start"], end = items["timeline/anna/end"];
    const double begin_x = start[0], second = (end[0] + end[2] - begin_x) / 2;  // the clip lasts two
    const std::vector<double> forwards = items["timeline/anna/waveform"];
    EXPECT_NEAR(forwards[0], begin_x + second, 1.5);
    EXPECT_NEAR(forwards[0] + forwards[2], begin_x + 2 * second, 1.5);

    const double x = begin_x + 1.5 * second, y = forwards[1] + 0.67 * forwards[3];  // away from the line of the images
    const auto shows_wave = [&](const media::Image& window) {
        return brightness_at(window, x, y) - brightness_at(window, x - second, forwards[1] + 0.4 * forwards[3]);
    };
    const int heard = shows_wave(hands->window());
    hands->click("stage/anna/sound");
    hands->until("anna to be muted", [](const json& now) { return now["muted"].size() == 1; });
    const int muted = shows_wave(hands->window());
    EXPECT_GT(muted, 20);
    EXPECT_GT(heard, muted + 40) << "it is fainter when it is muted";

    hands->click("timeline/anna/menu");
    hands->click("timeline/anna/reverse");
    hands->key("Escape");
    const json backwards = hands->until("the sound to be turned", [&](const json& now) {
        const json area = now["items"].value("timeline/anna/waveform", json());
        return area.is_array() && area[0] < forwards[0] - second / 2;
    })["items"]["timeline/anna/waveform"];
    EXPECT_NEAR(backwards[0].get<double>(), begin_x, 1.5);
    EXPECT_NEAR(backwards[0].get<double>() + backwards[2].get<double>(), begin_x + (1 - 1 / kFps) * second, 1.5)
        << "from the beginning of the last image on";
}

TEST_F(Watching, WhatIsNoSoundIsSaidAndSeenWhenItIsOne) {
    write_wav(file("mended.wav"), stereo_tone(media::kSoundRate), 2, media::kSoundRate);
    std::filesystem::copy_file(file("mended.wav"), file("song.wav"));
    done({"stage", "set", stage, "anna", "--sound", file("song.wav")});
    std::ofstream(file("song.wav")) << "no sound at all";
    const auto hands = open(stage);
    const json report = hands->until_notice("song.wav");
    EXPECT_FALSE(report["items"].contains("timeline/anna/waveform"));
    std::filesystem::rename(file("mended.wav"), file("song.wav"));
    hands->centre_of("timeline/anna/waveform");
}

TEST_F(Watching, LooksAroundAndComesToRest) {
    const auto hands = open(stage);
    hands->until_rest();
    media::Image before = hands->image();
    const auto changes_by = [&](const char* what, const std::function<void()>& act) {
        const uint64_t view = hands->seen()["view"];
        act();
        EXPECT_GT(hands->until_rest()["view"], view) << what;
        media::Image after = hands->image();
        EXPECT_TRUE(other(before, after)) << what;
        before = std::move(after);
    };
    changes_by("orbit", [&] { hands->drag(hands->in_image(0.5, 0.2), hands->in_image(0.8, 0.25)); });
    changes_by("pan", [&] { hands->drag(hands->in_image(0.5, 0.2), hands->in_image(0.6, 0.3), 2); });
    changes_by("turn", [&] { hands->drag(hands->in_image(0.5, 0.2), hands->in_image(0.55, 0.2), 3); });
    changes_by("closer", [&] { hands->wheel(hands->in_image(0.5, 0.2), 3); });
    changes_by("fly", [&] {
        for (int i = 0; i < 3; ++i) hands->key("d");
    });
    EXPECT_EQ(hands->seen()["modified"], false) << "nothing of it is an edit";
}

// Presses of keys may be much shorter than a frame takes; none may be lost.
TEST_F(Watching, ShortPressesAreNotLost) {
    const auto hands = open(stage);
    hands->until_rest();
    for (int i = 0; i < 6; ++i) hands->key("period");
    EXPECT_NEAR(hands->until_rest()["time_s"].get<double>() * kFps, 6, 1e-6);
    for (int i = 0; i < 4; ++i) hands->key("comma");
    EXPECT_NEAR(hands->until_rest()["time_s"].get<double>() * kFps, 2, 1e-6);
}

TEST_F(Watching, TheWindowTakesAnySize) {
    const auto hands = open(stage);
    hands->until_rest();
    const auto image_width = [&](const json& now) { return now["items"]["image"][2].get<double>(); };
    const double width = image_width(hands->seen());
    hands->resize(840, 460);
    hands->until("a wider image", [&](const json& now) { return image_width(now) == width + 200; });
    hands->until_rest();
    const media::Image large = hands->image();
    EXPECT_EQ(large.width, std::lround(width + 200));
    EXPECT_TRUE(same(large, rendered(large)));

    for (const auto& [w, h] : {std::pair(200, 100), std::pair(41, 33), std::pair(1280, 30), std::pair(640, 400)}) {
        hands->resize(w, h);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    hands->until("the first size", [&](const json& now) { return image_width(now) == width; });
    hands->until_rest();
    const media::Image again = hands->image();
    EXPECT_TRUE(same(again, rendered(again)));
}

TEST_F(Watching, AWindowThatIsAwayComesBack) {
    const auto hands = open(stage);
    hands->until_rest();
    const media::Image before = hands->image();
    hands->minimise();
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    hands->show_again();
    hands->key("period");
    hands->key("comma");
    hands->until_rest();
    EXPECT_TRUE(same(before, hands->image()));

    hands->key("F11");
    const json full = hands->until("the whole screen", [](const json& now) {
        const std::vector<double> at = now["items"]["image"];
        return at[2] > 900 && at[3] > 500;
    });
    hands->until_rest();
    hands->key("F11");
    hands->until("the window again", [&](const json& now) {
        const std::vector<double> at = now["items"]["image"];
        return at[2] == before.width && at[3] == before.height;
    });
    hands->until_rest();
    EXPECT_TRUE(same(before, hands->image()));
}

TEST_F(Watching, PanelsGoAwayAndHelpComes) {
    const auto hands = open(stage);
    hands->until_rest();
    const double width = hands->seen()["items"]["image"][2];
    hands->key("Tab");
    hands->until("no panels", [&](const json& now) { return now["items"]["image"][2] == 640.0; });
    const media::Image wide = hands->image();
    EXPECT_TRUE(same(wide, rendered(wide)));
    hands->key("Tab");
    hands->until("panels", [&](const json& now) { return now["items"]["image"][2] == width; });
    hands->until_rest();
    const media::Image without = hands->window();
    hands->key("shift+slash");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(other(without, hands->window()));
}

TEST_F(Watching, WhatCannotBeOpenedIsSaid) {
    write_text(file("broken.gltf"), R"({"asset":{"version":"2.0"},"nodes":[{"extensions":)");
    const auto hands = open(file("broken.gltf"));
    hands->until_notice("broken.gltf");
    EXPECT_EQ(hands->seen()["open"], "");
    hands->key("ctrl+q");
    EXPECT_EQ(hands->wait_for_end(), 0);
}

TEST_F(Watching, ShadersThatChangeAreSeen) {
    const std::filesystem::path shaders = folder.path / "shaders", changed = shaders / "rays/show.glsl";
    std::filesystem::copy(NEUVV_SHADERS, shaders, std::filesystem::copy_options::recursive);
    const std::string text = read_text(changed), stored = "packUnorm4x8(colour)";
    const size_t at = text.find(stored);
    ASSERT_NE(at, std::string::npos);
    auto write = [&, later = 0](const std::string& now) mutable {
        const auto before = std::filesystem::last_write_time(changed);
        std::ofstream(changed) << now;
        std::filesystem::last_write_time(changed, before + std::chrono::seconds(++later));
    };
    Hands hands(*screen, folder.path, {stage, "--size", "640x400", "--shaders", shaders.string()});
    hands.until_rest();
    const media::Image before = hands.image();
    write(std::string(text).replace(at, stored.size(), "packUnorm4x8(colour.bgra)"));
    hands.until_notice("shaders made anew");
    hands.until_rest();
    const media::Image swapped = hands.image();
    media::Image expected = before;
    for (size_t i = 0; i < expected.rgba.size(); i += 4) std::swap(expected.rgba[i], expected.rgba[i + 2]);
    EXPECT_TRUE(same(swapped, expected));
    EXPECT_TRUE(other(swapped, before));

    write(std::string(text).replace(at, stored.size(), "nonsense"));
    hands.until_notice("'nonsense' : undeclared identifier");
    EXPECT_TRUE(same(swapped, hands.image())) << "the last ones stay";
    hands.until("no notices", [](const json& now) { return now["notices"].empty(); });
    write(text);
    hands.until_notice("shaders made anew");
    hands.until_rest();
    EXPECT_TRUE(same(before, hands.image()));
}

TEST_F(Watching, QuitsWithCodeZero) {
    const auto hands = open(stage);
    hands->until_rest();
    hands->click("menu/File");
    hands->click("menu/Quit");
    EXPECT_EQ(hands->wait_for_end(), 0);
}

TEST(ViewerWithoutDisplay, SaysSoInOneLine) {
    for (const char* display : {"", ":987"}) {
        const ProgramResult result = run_neuvv({"view"}, std::string("env -u WAYLAND_DISPLAY DISPLAY=") + display);
        EXPECT_EQ(result.code, 1) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_NE(result.err.find("neuvv render"), std::string::npos) << result.err;
    }
}

}  // namespace
}  // namespace neuvv::test
