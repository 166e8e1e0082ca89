#include "tools/viewer/preferences.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>

#include "base/error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

struct PreferencesFile : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "viewer.json";

    viewer::LoadedPreferences load(const std::string& text) const {
        write_text(file, text);
        return viewer::load_preferences(file);
    }
    // One line that names the file.
    void expect_message(const viewer::LoadedPreferences& loaded, const std::string& part) const {
        EXPECT_NE(loaded.message.find(file.string()), std::string::npos) << loaded.message;
        EXPECT_NE(loaded.message.find(part), std::string::npos) << part << " not in: " << loaded.message;
        EXPECT_EQ(loaded.message.find('\n'), std::string::npos) << loaded.message;
        EXPECT_LT(loaded.message.size(), 1000u);
    }
};

void expect_defaults(const viewer::Preferences& read) {
    EXPECT_EQ(read.window.width, ui::WindowGeometry().width);
    EXPECT_EQ(read.window.height, ui::WindowGeometry().height);
    EXPECT_FALSE(read.window.at);
    EXPECT_FALSE(read.window.maximised);
    EXPECT_TRUE(read.recent.empty());
    EXPECT_TRUE(read.panels.empty());
    EXPECT_EQ(read.ui_scale, 1);
    EXPECT_EQ(read.preview.resolution, viewer::PreviewQuality().resolution);
    EXPECT_EQ(read.preview.samples, viewer::PreviewQuality().samples);
    EXPECT_EQ(read.layer, "");
}

TEST_F(PreferencesFile, WhatIsSavedIsRead) {
    viewer::Preferences saved;
    saved.window = {1234, 777, std::pair{-40, 12}, true};
    saved.recent = {"/a/b.gltf", "/c d/ü.nvv"};
    saved.panels["stage"] = {false, 250.5};
    saved.panels["lights"] = {true, 300};
    saved.ui_scale = 1.25;
    saved.preview = {0.5, 16, false};
    saved.layer = "depth";
    const std::filesystem::path deep = folder.path / "new" / "folder" / "viewer.json";
    viewer::save_preferences(deep, saved);
    const viewer::LoadedPreferences loaded = viewer::load_preferences(deep);
    EXPECT_EQ(loaded.message, "");
    const viewer::Preferences& read = loaded.preferences;
    EXPECT_EQ(read.window.width, 1234);
    EXPECT_EQ(read.window.height, 777);
    EXPECT_EQ(read.window.at, std::pair(-40, 12));
    EXPECT_TRUE(read.window.maximised);
    EXPECT_EQ(read.recent, saved.recent);
    ASSERT_EQ(read.panels.size(), 2u);
    EXPECT_FALSE(read.panels.at("stage").open);
    EXPECT_EQ(read.panels.at("stage").width, 250.5);
    EXPECT_EQ(read.ui_scale, 1.25);
    EXPECT_EQ(read.preview.resolution, 0.5);
    EXPECT_EQ(read.preview.samples, 16u);
    EXPECT_FALSE(read.preview.far_levels);
    EXPECT_EQ(read.layer, "depth");
    viewer::save_preferences(deep, read);
    EXPECT_EQ(viewer::load_preferences(deep).preferences.recent, saved.recent);
}

TEST_F(PreferencesFile, AMissingFileIsNoFault) {
    const viewer::LoadedPreferences loaded = viewer::load_preferences(folder.path / "none" / "viewer.json");
    EXPECT_EQ(loaded.message, "");
    expect_defaults(loaded.preferences);
}

TEST_F(PreferencesFile, UnknownMembersStay) {
    viewer::LoadedPreferences loaded =
        load(R"({"later": {"x": [1, null, "ü"]}, "window": {"width": 800, "screen": "left"},
                                        "panels": {"stage": {"open": true, "dock": 3}}, "uiScale": 2})");
    EXPECT_EQ(loaded.message, "");
    loaded.preferences.window.width = 900;
    loaded.preferences.panels["stage"].open = false;
    viewer::save_preferences(file, loaded.preferences);
    const auto json = nlohmann::json::parse(read_text(file));
    EXPECT_EQ(json["later"], nlohmann::json::parse(R"({"x": [1, null, "ü"]})"));
    EXPECT_EQ(json["window"]["screen"], "left");
    EXPECT_EQ(json["window"]["width"], 900);
    EXPECT_EQ(json["panels"]["stage"]["dock"], 3);
    EXPECT_EQ(json["panels"]["stage"]["open"], false);
    EXPECT_FALSE(json["window"].contains("x")) << "no place was known";
}

TEST_F(PreferencesFile, DamagedFilesGiveDefaults) {
    const char* damaged[] = {"",
                             "{",
                             "[]",
                             "null",
                             "12",
                             "{\"window\": NaN}",
                             "{\"uiScale\": 1e999}",
                             "{\"a\": \"\xff\"}",
                             "{} {}",
                             "{\"window\": {\"width\": 800}"};
    for (const char* text : damaged) {
        const viewer::LoadedPreferences loaded = load(text);
        expect_message(loaded, "defaults are used");
        expect_defaults(loaded.preferences);
        viewer::save_preferences(file, loaded.preferences);
        EXPECT_EQ(viewer::load_preferences(file).message, "") << text;
    }
}

TEST_F(PreferencesFile, OneWrongMemberLeavesTheOthers) {
    const std::pair<const char*, const char*> wrong[] = {
        {R"("window": 3)", "window"},
        {R"("window": {"width": "wide"})", "window.width"},
        {R"("window": {"height": 1e300})", "window.height"},
        {R"("window": {"width": -5})", "window.width"},
        {R"("window": {"x": 5e9, "y": 1})", "window.x"},
        {R"("window": {"maximised": 1})", "window.maximised"},
        {R"("recent": "/a")", "recent"},
        {R"("recent": ["relative"])", "recent[0]"},
        {R"("recent": ["/a\u0000b"])", "recent[0]"},
        {R"("panels": [])", "panels"},
        {R"("panels": {"a": {"width": 1e-9}})", "panels.width"},
        {R"("panels": {"a": 3})", "panels"},
        {R"("uiScale": 0)", "uiScale"},
        {R"("uiScale": 123456789012345678901234567890)", "uiScale"},
        {R"("preview": {"samples": 18446744073709551615})", "preview.samples"},
        {R"("preview": {"resolution": null})", "preview.resolution"}};
    for (const auto& [member, name] : wrong) {
        const viewer::LoadedPreferences loaded = load(std::string(R"({"layer": "depth", )") + member + "}");
        expect_message(loaded, name);
        EXPECT_EQ(loaded.preferences.layer, "depth");
        viewer::Preferences otherwise = loaded.preferences;
        otherwise.layer.clear();
        otherwise.panels.clear();
        expect_defaults(otherwise);
        viewer::save_preferences(file, loaded.preferences);
        EXPECT_EQ(viewer::load_preferences(file).message, "") << "saving mends " << member;
    }
    expect_message(load(R"({"layer": ")" + std::string(5000, 'x') + "\"}"), "layer");
}

TEST_F(PreferencesFile, DeepNestingIsRefused) {
    for (const char* bracket : {"[", "{\"a\":"}) {
        std::string deep = "{\"later\": ";
        for (int i = 0; i < 150'000; ++i) deep += bracket;
        expect_defaults(load(deep).preferences);
    }
    std::string closed = "{\"later\": " + std::string(400'000, '[') + std::string(400'000, ']') + "}";
    const viewer::LoadedPreferences loaded = load(closed);
    expect_message(loaded, "damaged");
    viewer::save_preferences(file, loaded.preferences);
    EXPECT_LT(std::filesystem::file_size(file), 1000u);
}

TEST_F(PreferencesFile, ManyMembersAreCut) {
    std::string panels, recent;
    for (int i = 0; i < 5000; ++i) panels += (i ? ", \"" : "\"") + std::to_string(i) + "\": {}";
    for (int i = 0; i < 5000; ++i) recent += (i ? ", \"/" : "\"/") + std::to_string(i) + "\"";
    const viewer::LoadedPreferences loaded = load("{\"panels\": {" + panels + "}, \"recent\": [" + recent + "]}");
    expect_message(loaded, "panels");
    EXPECT_EQ(loaded.preferences.panels.size(), 64u);
    ASSERT_EQ(loaded.preferences.recent.size(), viewer::kMaxRecentFiles);
    EXPECT_EQ(loaded.preferences.recent.front(), "/0");
}

TEST_F(PreferencesFile, WhatIsNoSuchFileIsNotRead) {
    EXPECT_NE(viewer::load_preferences(folder.path).message.find("is not a file"), std::string::npos);
    write_text(file, "{}");
    std::filesystem::resize_file(file, uint64_t{1} << 30);
    expect_message(viewer::load_preferences(file), "1073741824 bytes");
    std::filesystem::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    expect_message(viewer::load_preferences(file), "is not a file");
    EXPECT_THROW(viewer::save_preferences(file, {}), RuntimeFailure);
    std::filesystem::remove(file);
    std::filesystem::create_symlink(file, file);
    expect_message(viewer::load_preferences(file), "is not a file");
}

TEST_F(PreferencesFile, RandomDamageNeverThrows) {
    viewer::Preferences saved;
    saved.recent = {"/a/b.gltf"};
    saved.panels["stage"] = {};
    viewer::save_preferences(file, saved);
    const std::string sound = read_text(file);
    std::mt19937 random(1);
    for (int i = 0; i < 500; ++i) {
        std::string text = sound;
        for (int k = 0; k < 3; ++k) {
            const size_t at = random() % text.size();
            if (random() % 2)
                text[at] = static_cast<char>(random());
            else
                text.replace(at, random() % 4, std::to_string(static_cast<int>(random())));
        }
        const viewer::LoadedPreferences loaded = load(text);
        EXPECT_GE(loaded.preferences.window.width, 320);
        EXPECT_LE(loaded.preferences.recent.size(), viewer::kMaxRecentFiles);
        if (i % 50 == 0) viewer::save_preferences(file, loaded.preferences);
    }
}

TEST_F(PreferencesFile, RecentFilesComeFirstOnceAndAbsolute) {
    viewer::Preferences preferences;
    for (int i = 0; i < 12; ++i) viewer::remember_file(preferences, "/f" + std::to_string(i));
    ASSERT_EQ(preferences.recent.size(), viewer::kMaxRecentFiles);
    EXPECT_EQ(preferences.recent.front(), "/f11");
    EXPECT_EQ(preferences.recent.back(), "/f2");
    viewer::remember_file(preferences, "/x/../f5");
    EXPECT_EQ(preferences.recent.size(), viewer::kMaxRecentFiles);
    EXPECT_EQ(preferences.recent[0], "/f5");
    EXPECT_EQ(preferences.recent[1], "/f11");
    EXPECT_EQ(std::count(preferences.recent.begin(), preferences.recent.end(), "/f5"), 1);
    viewer::remember_file(preferences, "here.gltf");
    EXPECT_EQ(preferences.recent[0], std::filesystem::current_path() / "here.gltf");
}

TEST_F(PreferencesFile, FilesThatAreGoneStayListed) {
    write_text(folder.path / "there.nvv", "");
    viewer::Preferences preferences;
    viewer::remember_file(preferences, folder.path / "gone.nvv");
    viewer::remember_file(preferences, folder.path / "there.nvv");
    viewer::save_preferences(file, preferences);
    const viewer::Preferences read = viewer::load_preferences(file).preferences;
    ASSERT_EQ(read.recent.size(), 2u);
    EXPECT_EQ(viewer::recent_files_exist(read), (std::vector<bool>{true, false}));
}

TEST_F(PreferencesFile, PathsThatJsonCannotHoldAreLeftOut) {
    viewer::Preferences preferences;
    preferences.recent = {"/good", "/bad\xff", "/fine"};
    viewer::save_preferences(file, preferences);
    EXPECT_EQ(viewer::load_preferences(file).preferences.recent,
              (std::vector<std::filesystem::path>{"/good", "/fine"}));
}

TEST_F(PreferencesFile, AFolderThatCannotBeMadeIsNamed) {
    write_text(folder.path / "file", "");
    EXPECT_THROW(viewer::save_preferences(folder.path / "file" / "viewer.json", {}), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv
