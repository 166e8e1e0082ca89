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
    headset::OnStage on;
    headset::HoldSettings hold;

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
    settings.load(on, hold);
    on.comfort.smooth_walk = true;
    on.comfort.vignette = false;
    on.brush.tip = headset::HandBrush::Tip::kBox;
    on.brush.does = headset::HandBrush::Does::kErase;
    on.brush.radius_m = 0.123;
    on.brush.colour = {0.1f, 0.5f, 1};
    on.panel_on_wrist = true;
    hold.upright = false;
    settings.save(on, hold);

    headset::OnStage later;
    headset::HoldSettings held;
    headset::HeadsetSettings(file).load(later, held);
    EXPECT_TRUE(later.editor.take_notices().empty());
    EXPECT_TRUE(later.comfort.smooth_walk);
    EXPECT_FALSE(later.comfort.smooth_turn);
    EXPECT_FALSE(later.comfort.vignette);
    EXPECT_EQ(later.brush.tip, headset::HandBrush::Tip::kBox);
    EXPECT_EQ(later.brush.does, headset::HandBrush::Does::kErase);
    EXPECT_EQ(later.brush.radius_m, 0.123);
    EXPECT_EQ(later.brush.colour, on.brush.colour);
    EXPECT_TRUE(later.panel_on_wrist);
    EXPECT_FALSE(held.upright);
    EXPECT_TRUE(held.snaps_to_floor);
}

TEST_F(HeadsetSettingsTest, WhereNothingWasChosenNothingIsWritten) {
    headset::HeadsetSettings settings(file);
    settings.load(on, hold);
    settings.save(on, hold);
    EXPECT_FALSE(std::filesystem::exists(file));
    headset::HeadsetSettings nowhere("");
    nowhere.load(on, hold);
    on.comfort.smooth_turn = true;
    nowhere.save(on, hold);
}

TEST_F(HeadsetSettingsTest, WhatANewerProgramWroteStays) {
    write(R"({"comfort": {"snap_deg": 45, "seated": true}, "gloves": [1, 2]})");
    headset::HeadsetSettings settings(file);
    settings.load(on, hold);
    EXPECT_EQ(on.comfort.snap_deg, 45);
    on.comfort.smooth_turn = true;
    settings.save(on, hold);
    const nlohmann::json now = read();
    EXPECT_EQ(now["gloves"], nlohmann::json({1, 2}));
    EXPECT_EQ(now["comfort"]["seated"], true);
    EXPECT_EQ(now["comfort"]["smoothTurn"], true);
    EXPECT_EQ(now["comfort"]["snap_deg"], 45);
}

TEST_F(HeadsetSettingsTest, WhatIsWrongIsToldAndHasItsDefault) {
    write(
        R"({"comfort": {"snap_deg": 1e9, "vignette": 3}, "brush": {"tip": "cone", "colour": {"red": -1}, "radius_m": 0.2}})");
    headset::HeadsetSettings(file).load(on, hold);
    const std::vector<editor::Notice> told = on.editor.take_notices();
    ASSERT_EQ(told.size(), 1u);
    for (const char* name : {"comfort.snap_deg", "comfort.vignette", "brush.tip", "brush.colour.red"})
        EXPECT_NE(told[0].text.find(name), std::string::npos) << told[0].text;
    EXPECT_EQ(on.comfort.snap_deg, headset::Comfort().snap_deg);
    EXPECT_TRUE(on.comfort.vignette);
    EXPECT_EQ(on.brush.tip, headset::HandBrush::Tip::kBall);
    EXPECT_EQ(on.brush.radius_m, 0.2) << "what is right beside it is taken";
}

TEST_F(HeadsetSettingsTest, ADamagedFileIsTold) {
    write("{\"comfort\": ");
    headset::HeadsetSettings(file).load(on, hold);
    const std::vector<editor::Notice> told = on.editor.take_notices();
    ASSERT_EQ(told.size(), 1u);
    EXPECT_NE(told[0].text.find("is damaged"), std::string::npos) << told[0].text;
}

TEST_F(HeadsetSettingsTest, AFolderThatCannotBeWrittenIsAFailure) {
    headset::HeadsetSettings settings(folder.path / "stage.gltf/headset.json");
    std::ofstream(folder.path / "stage.gltf") << "a file";
    settings.load(on, hold);
    on.comfort.smooth_turn = true;
    EXPECT_THROW(settings.save(on, hold), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test
