// The mirror: a window on the desktop that shows what the left eye sees.
#include <future>

#include "support/child_process.h"
#include "tools/ui/window_geometry.h"
#include "viewer_window/hands.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

// How an image lies in the centre of a window, as large as fits: its scale, and its upper left corner in pixels of the
// window.
struct Fit {
    double scale, left, top;
};
Fit fit_of(const media::Image& eye, const ui::WindowGeometry& window) {
    const double scale = std::min(double(window.width) / eye.width, double(window.height) / eye.height);
    return {scale, (window.width - scale * eye.width) / 2, (window.height - scale * eye.height) / 2};
}

// Whether an eye's image is shown in the centre of a window, as large as fits. Pixels of the window that lie outside
// the screen are ignored. The centre of an image's pixel is up to half a pixel from the centre of a screen's pixel, so
// the tolerance allows for a share of the neighbouring pixel.
bool is_mirrored(const media::Image& eye, const media::Image& screen, const ui::WindowGeometry& window) {
    const auto [scale, left, top] = fit_of(eye, window);
    int max = 0;
    for (uint32_t y = 4; y < eye.height; y += 8)
        for (uint32_t x = 4; x < eye.width; x += 8) {
            const auto at_x = static_cast<uint32_t>(left + scale * (x + 0.5)),
                       at_y = static_cast<uint32_t>(top + scale * (y + 0.5));
            if (at_x >= screen.width || at_y >= screen.height) continue;
            for (int c = 0; c < 3; ++c) max = std::max(max, std::abs(eye.at(x, y)[c] - screen.at(at_x, at_y)[c]));
        }
    return max <= 255 * 0.5 / scale + 1;
}

// What a window looks like that shows the image.
media::Image image_of_window(const ui::WindowGeometry& window, const media::Image& eye) {
    media::Image shown(static_cast<uint32_t>(window.width), static_cast<uint32_t>(window.height));
    const auto [scale, left, top] = fit_of(eye, window);
    for (uint32_t y = 0; y < shown.height; ++y)
        for (uint32_t x = 0; x < shown.width; ++x) {
            const double at_x = (x + 0.5 - left) / scale, at_y = (y + 0.5 - top) / scale;
            if (at_x >= 0 && at_y >= 0 && at_x < eye.width && at_y < eye.height)
                std::copy_n(eye.at(static_cast<uint32_t>(at_x), static_cast<uint32_t>(at_y)), 4, shown.at(x, y));
        }
    return shown;
}

struct Mirror : XrSession {
    std::optional<VirtualScreen> screen;
    void SetUp() override {
        if (const std::string missing = why_no_hands(); !missing.empty()) GTEST_SKIP() << missing;
        screen.emplace(folder.path);
        setenv("DISPLAY", screen->display().c_str(), 1);
    }
    // Runs the program; the second value is whether the window has shown the image.
    std::pair<XrRun, bool> run_until_shown(const XrScript& script, const std::vector<std::string>& options,
                                           const media::Image& image) {
        auto running = std::async(std::launch::async, [&] { return run(script, options); });
        bool shown = false;
        while (running.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
            shown = shown || is_mirrored(image, screen->image(), {});
        return {running.get(), shown};
    }
    // The number of the window that has these words in its title; empty: none has.
    std::string window_with(const std::string& words) const {
        const std::filesystem::path found = folder.path / "xdotool.txt";
        ChildProcess search({"/usr/bin/env", "xdotool", "search", "--name", words}, found);
        return search.wait() == 0 ? read_text(found) : "";
    }
};

TEST_F(Mirror, ItShowsTheLeftEye) {
    XrScript script;
    script.save(10);
    script.end(14);
    const XrRun plain = run(script);
    const media::Image eye = plain.image(10, "left");
    EXPECT_FALSE(is_mirrored(eye, screen->image(), {})) << "nothing is shown yet";
    EXPECT_TRUE(is_mirrored(eye, image_of_window({}, eye), {}));
    EXPECT_FALSE(is_mirrored(eye, image_of_window({}, plain.image(10, "right")), {})) << "the other eye is told apart";
    script.json["time"] = "real";
    script.end(80);
    const auto [run, shown] = run_until_shown(script, {"--mirror"}, eye);
    expect_clean(run);
    EXPECT_TRUE(same_pixels(eye, run.image(10, "left"))) << "the headset is shown the same";
    EXPECT_TRUE(shown) << "the window does not show the left eye";
}

TEST_F(Mirror, ItShowsThePanel) {
    XrScript script;
    script.hand(0, "right", kRightHand, {3, 1, 0});
    script.hand(0, "left", kLeftHand, {-3, 1, -4});
    script.click(kReady, "left", "y/click");
    script.save(20);
    script.end(24);
    const XrRun plain = run(script, {"--no-mask"});
    expect_clean(plain);
    const media::Image seen = plain.image(20, "left_seen");
    EXPECT_FALSE(is_mirrored(plain.image(20, "left"), image_of_window({}, seen), {})) << "the panel is told apart";
    script.json["time"] = "real";
    script.end(90);
    const auto [run, shown] = run_until_shown(script, {"--no-mask", "--mirror"}, seen);
    expect_clean(run);
    EXPECT_TRUE(shown) << "the window does not show the panel";
}

TEST_F(Mirror, ItGoesOnWithTheSessionAfterALostOne) {
    XrScript script;
    script.json["profile"] = "";  // no hands in the image
    script.event(14, "lose_session");
    script.head(30, {0, 1.5, 0}, {0, 1.2, -2});
    script.head(31, {0, 1.5, 0}, {1, 1.2, -2});
    script.save(10);
    script.save(40);
    script.end(44);
    const XrRun plain = run(script, {}, false);
    const media::Image before = plain.image(10, "left"), after = plain.image(40, "left");
    EXPECT_FALSE(is_mirrored(before, image_of_window({}, after), {})) << "they are told apart";
    script.json["time"] = "real";
    script.end(110);
    const auto [run, shown] = run_until_shown(script, {"--mirror"}, after);
    EXPECT_EQ(run.code, 0) << run.log;
    EXPECT_TRUE(shown) << "the window does not show the next session";
}

TEST_F(Mirror, TheWindowTakesEventsWhileASessionIsLost) {
    XrScript script;
    script.event(14, "lose_session");
    script.json["fail"] = {
        {{"function", "xrCreateSession"}, {"result", "XR_ERROR_LIMIT_REACHED"}, {"skip", 1}, {"times", 9999}}};
    auto running = std::async(std::launch::async, [&] { return run(script, {"--mirror"}); });
    const auto is_running = [&] {
        return running.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready;
    };
    std::string window;
    while (is_running() && window.empty()) window = window_with("waits for the headset");
    ASSERT_FALSE(window.empty()) << "its title says that it waits " << running.get().log;
    ASSERT_EQ(ChildProcess({"/usr/bin/env", "python3", NEUVV_SOURCE_DIR "/tests/xr_session/close_window.py", window},
                           folder.path / "close.txt")
                  .wait(),
              0)
        << read_text(folder.path / "close.txt");
    const XrRun run = running.get();
    EXPECT_EQ(run.code, 0) << run.log << "\nelse it waits until its timeout";
    EXPECT_TRUE(run.seen.is_object()) << run.log;
}

}  // namespace
}  // namespace neuvv::test
