// Opening another stage or a stream inside the headset, and the plate that is seen meanwhile.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <future>

#include "edit/operations.h"
#include "support/child_process.h"
#include "support/environment_value.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Opening : XrSession {
    static constexpr int kOpened = 10 + 2 * kPress;  // from this frame on, the panel lists files (at_files)
    std::filesystem::path other;

    // The stages have a folder of their own, as each run adds one to `folder`, which the panel would list, too.
    Opening() {
        stage = write_stage("stage.gltf", "anna", -0.8);
        other = write_stage("other.gltf", "carla", -1.4);
    }
    std::filesystem::path write_stage(const std::string& name, const std::string& performer, double left_m) const {
        const std::filesystem::path path = folder.path / "show" / name;
        std::filesystem::create_directories(path.parent_path());
        stage::StageFile file = edit::new_stage(path);
        add_figure(file, performer, {left_m, 0, -2.8});
        edit::Placement eyes;
        eyes.at = glm::dvec3(0, 1.5, 0);
        eyes.aim = glm::dvec3(0, 1.5, -1);
        edit::place_node(file, edit::find_node(file, "camera"), eyes);
        stage::save_stage_file(file, path);
        return path;
    }
    static XrScript with_hands() {
        XrScript script;
        script.hand(0, "left", kLeftHand, {-3, 1, -4});
        script.hand(0, "right", kRightHand, {3, 1, -4});
        return script;
    }
    // Presses until the panel lists the files of the stage's folder. Returns its items.
    json at_files(XrScript& script) {
        script.click(kReady, "left", "y/click");
        press(script, 10, panel_after(script, kReady + 6), "stage page");
        press(script, 10 + kPress, panel_after(script, 10 + kPress), "open");
        return panel_after(script, kOpened);
    }
    media::Image watched(const std::filesystem::path& which) {
        stage = which;
        XrScript script = with_hands();
        script.save(10);
        script.end(12);
        return run(script, {}, false).image(10, "left");
    }
};

// What is seen of the status, which is below the centre of the view.
media::Image status_of(const XrRun& run, int frame) {
    const media::Image image = run.image(frame, "left");
    media::Image part(image.width / 2, image.height / 5);
    for (uint32_t y = 0; y < part.height; ++y)
        std::copy_n(image.at(image.width / 4, y + image.height * 13 / 20), size_t{4} * part.width, part.at(0, y));
    return part;
}

TEST_F(Opening, ThePanelOpensAnotherStage) {
    constexpr int kClosed = kOpened + kPress + 60, kEnd = kClosed + 20;
    XrScript script = with_hands();
    press(script, kOpened, at_files(script), "file other.gltf");
    script.hand(kClosed, "right", kRightHand, {3, 1, -4});
    script.click(kClosed, "left", "y/click");
    script.save(kEnd - 2);
    script.end(kEnd);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(run.seen["stage"], other.string()) << run.log;
    const media::Image before = watched(stage), truth = watched(other);
    EXPECT_FALSE(same_pixels(truth, before, 64)) << "the stages differ";
    EXPECT_TRUE(same_pixels(truth, run.image(kEnd - 2, "left")));
}

// The server holds its answer back until an image has been saved.
TEST_F(Opening, AnAddressIsTypedAndSeenToBeOpened) {
    const std::filesystem::path log = folder.path / "server.log";
    ASSERT_EQ(
        ChildProcess({NEUVV_PROGRAM, "publish", clip.string(), "-o", (folder.path / "a.nvs").string()}, log).wait(), 0)
        << read_text(log);
    const ChildProcess server(
        {"/usr/bin/env", "python3", NEUVV_SOURCE_DIR "/tests/stream/http_server.py", folder.path.string()}, log);
    int port = 0;
    ASSERT_TRUE(server.until([&] { return bool(std::ifstream(log) >> port) && port != 0; })) << "is python3 there?";

    constexpr int kKey = 6;  // the frames of a short press
    XrScript script = with_hands();
    script.json["width"] = script.json["height"] = 96;  // it is a long script
    press(script, kOpened, at_files(script), "file address");
    int frame = kOpened + kPress;
    const json keys = panel_after(script, frame);
    for (const char letter : fmt::format("http://127.0.0.1:{}/shut/a.nvs", port)) {
        press(script, frame, keys, std::string("key ") + letter);
        frame += kKey;
    }
    press(script, frame, keys, "key done");
    const int waits = frame + kPress, opened = waits + 60;
    for (const int saved : {frame, waits, opened}) script.save(saved);
    script.end(opened + 2);
    const EnvironmentValue cache("XDG_CACHE_HOME", (folder.path / "cache").c_str());
    const std::filesystem::path image = next_out() / fmt::format("frame_{:04}_left.png", waits);
    auto running = std::async(std::launch::async, [&] { return this->run(script, {}, false); });
    while (running.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready && !exists(image)) {
    }
    std::ofstream(folder.path / "open") << "";
    const XrRun run = running.get();
    expect_sound(run);
    EXPECT_EQ(std::filesystem::path(run.seen["stage"]).filename(), "a.gltf") << run.log;
    EXPECT_FALSE(same_pixels(status_of(run, frame), status_of(run, waits), 64)) << "it is seen to be opened";
    EXPECT_FALSE(same_pixels(run.image(waits, "left"), run.image(opened, "left"), 64)) << "it is shown";
}

TEST_F(Opening, FrameTimesAreSeenWhereTheyAreWanted) {
    XrScript script;
    script.json["profile"] = "";  // no hands in the image
    script.save(10);
    script.end(12);
    const XrRun without = run(script, {}, false);
    write_settings(R"({"panel": {"frameTimes": true}, "hands": {"hints": false}})");
    const XrRun with = run(script, {}, false);
    expect_sound(with);
    EXPECT_FALSE(same_pixels(status_of(with, 10), status_of(without, 10), 64));
}

}  // namespace
}  // namespace neuvv::test
