#include "tools/headset/settings.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/platform.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

struct HeadsetSettingsTest : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "config/headset.json";
    headset::HeadsetState state;
    headset::PerformerGrabSettings grab;

    void write(const std::string& text) {
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }
    nlohmann::json read() {
        const std::vector<uint8_t> bytes = read_file(file);
        return nlohmann::json::parse(bytes);
    }
};

TEST_F(HeadsetSettingsTest, WhatWasChosenComesBack) {
    headset::HeadsetSettings settings(file);
    settings.load(state, grab);
    state.comfort.smooth_walk = true;
    state.comfort.vignette = false;
    state.brush.tip = headset::HandBrush::Tip::kBox;
    state.brush.mode = headset::HandBrush::Mode::kErase;
    state.brush.radius_m = 0.123;
    state.brush.colour = {0.1f, 0.5f, 1};
    state.brush.by_ray = true;
    state.panel_on_wrist = true;
    state.left_handed = true;
    state.hints = false;
    grab.upright = false;
    grab.steps_heading = true;
    settings.save(state, grab);

    headset::HeadsetState later;
    headset::PerformerGrabSettings later_grab;
    headset::HeadsetSettings(file).load(later, later_grab);
    EXPECT_TRUE(later.editor.take_notices().empty());
    EXPECT_TRUE(later.comfort.smooth_walk);
    EXPECT_FALSE(later.comfort.smooth_turn);
    EXPECT_FALSE(later.comfort.vignette);
    EXPECT_EQ(later.brush.tip, headset::HandBrush::Tip::kBox);
    EXPECT_EQ(later.brush.mode, headset::HandBrush::Mode::kErase);
    EXPECT_EQ(later.brush.radius_m, 0.123);
    EXPECT_EQ(later.brush.colour, state.brush.colour);
    EXPECT_TRUE(later.brush.by_ray);
    EXPECT_TRUE(later.panel_on_wrist);
    EXPECT_FALSE(later_grab.upright);
    EXPECT_TRUE(later_grab.snaps_to_floor);
    EXPECT_TRUE(later.left_handed);
    EXPECT_FALSE(later.hints);
    EXPECT_TRUE(later_grab.steps_heading);
    EXPECT_FALSE(later_grab.steps_place);
}

TEST_F(HeadsetSettingsTest, WhereNothingWasChosenNothingIsWritten) {
    headset::HeadsetSettings settings(file);
    settings.load(state, grab);
    settings.save(state, grab);
    EXPECT_FALSE(std::filesystem::exists(file));
    headset::HeadsetSettings nowhere("");
    nowhere.load(state, grab);
    state.comfort.smooth_turn = true;
    nowhere.save(state, grab);
}

TEST_F(HeadsetSettingsTest, TheRoomIsKeptOnceTheUserHasChosen) {
    headset::HeadsetSettings settings(file);
    settings.load(state, grab);
    state.comfort.smooth_turn = true;
    settings.save(state, grab);
    EXPECT_FALSE(read().contains("room")) << "the runtime's preference is not the user's";
    for (const bool shown : {true, false}) {
        state.wants_room = shown;
        settings.save(state, grab);
        headset::HeadsetState later;
        headset::HeadsetSettings(file).load(later, grab);
        EXPECT_EQ(later.wants_room, std::optional(shown));
    }
    write(R"({"room": {"shown": 1}})");
    headset::HeadsetState later;
    headset::HeadsetSettings(file).load(later, grab);
    EXPECT_EQ(later.wants_room, std::nullopt);
    EXPECT_NE(later.editor.take_notices().at(0).text.find("room.shown"), std::string::npos);
}

TEST_F(HeadsetSettingsTest, WhatANewerProgramWroteStays) {
    write(R"({"comfort": {"snap_deg": 45, "seated": true}, "gloves": [1, 2]})");
    headset::HeadsetSettings settings(file);
    settings.load(state, grab);
    EXPECT_EQ(state.comfort.snap_deg, 45);
    state.comfort.smooth_turn = true;
    settings.save(state, grab);
    const nlohmann::json now = read();
    EXPECT_EQ(now["gloves"], nlohmann::json({1, 2}));
    EXPECT_EQ(now["comfort"]["seated"], true);
    EXPECT_EQ(now["comfort"]["smoothTurn"], true);
    EXPECT_EQ(now["comfort"]["snap_deg"], 45);
}

TEST_F(HeadsetSettingsTest, WhatIsWrongIsReportedAndHasItsDefault) {
    write(
        R"({"comfort": {"snap_deg": 1e9, "vignette": 3}, "brush": {"tip": "cone", "colour": {"red": -1}, "radius_m": 0.2}})");
    headset::HeadsetSettings(file).load(state, grab);
    const std::vector<editor::Notice> notices = state.editor.take_notices();
    ASSERT_EQ(notices.size(), 1u);
    for (const char* name : {"comfort.snap_deg", "comfort.vignette", "brush.tip", "brush.colour.red"})
        EXPECT_NE(notices[0].text.find(name), std::string::npos) << notices[0].text;
    EXPECT_EQ(state.comfort.snap_deg, headset::Comfort().snap_deg);
    EXPECT_TRUE(state.comfort.vignette);
    EXPECT_EQ(state.brush.tip, headset::HandBrush::Tip::kBall);
    EXPECT_EQ(state.brush.radius_m, 0.2) << "what is right beside it is taken";
}

TEST_F(HeadsetSettingsTest, ADamagedFileIsTold) {
    write("{\"comfort\": ");
    headset::HeadsetSettings(file).load(state, grab);
    const std::vector<editor::Notice> notices = state.editor.take_notices();
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_NE(notices[0].text.find("is damaged"), std::string::npos) << notices[0].text;
}

TEST_F(HeadsetSettingsTest, AFolderThatCannotBeWrittenIsAFailure) {
    headset::HeadsetSettings settings(folder.path / "stage.gltf/headset.json");
    std::ofstream(folder.path / "stage.gltf") << "a file";
    settings.load(state, grab);
    state.comfort.smooth_turn = true;
    EXPECT_THROW(settings.save(state, grab), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test
