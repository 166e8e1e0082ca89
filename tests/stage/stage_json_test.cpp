#include "stage/file/stage_json.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stage/file/json_splice.h"
#include "stage/stage.h"
#include "support/temporary_folder.h"
#include "tests/stage/stage_files.h"

namespace neuvv {
namespace {

using nlohmann::ordered_json;
using stage::StageJson;

StageJson some_json() {
    return StageJson(
        ordered_json::parse(R"({"asset":{"version":"2.0"},"nodes":[{"name":"a"},{}],"buffers":["long"]})"));
}

TEST(StageJson, CopiesShareWhatIsNotEdited) {
    StageJson json = some_json();
    const StageJson before = json;
    for (const char* name : {"asset", "nodes", "buffers", "none"}) EXPECT_TRUE(json.shares(before, name)) << name;
    json.edit("nodes")[0]["name"] = "b";
    EXPECT_FALSE(json.shares(before, "nodes"));
    EXPECT_EQ(before["nodes"][0]["name"], "a");
    EXPECT_EQ(json["nodes"][0]["name"], "b");
    EXPECT_TRUE(json.shares(before, "buffers"));
    const ordered_json* edited = json.find("nodes");
    json.edit("nodes")[1]["name"] = "c";
    EXPECT_EQ(json.find("nodes"), edited) << "nobody else holds it: no copy";
    EXPECT_NE(json, before);
    json.erase("asset");
    EXPECT_FALSE(json.shares(before, "asset"));
    EXPECT_EQ(before.size(), 3u);
    EXPECT_EQ(json.size(), 2u);
}

TEST(StageJson, EqualValuesAreSharedAgain) {
    StageJson json = some_json();
    const StageJson before = json;
    json.edit("nodes");
    json.edit("buffers").push_back("more");
    EXPECT_FALSE(json.shares(before, "nodes"));
    json.share(before);
    EXPECT_TRUE(json.shares(before, "nodes"));
    EXPECT_FALSE(json.shares(before, "buffers"));
    EXPECT_EQ(some_json(), before) << "equal, though nothing is shared";
    StageJson other_order(
        ordered_json::parse(R"({"nodes":[{"name":"a"},{}],"asset":{"version":"2.0"},"buffers":["long"]})"));
    EXPECT_NE(other_order, before) << "as ordered_json has it";
}

TEST(StageJson, SaysWhatItHolds) {
    StageJson json = some_json();
    EXPECT_TRUE(json.contains("nodes"));
    EXPECT_EQ(json.find("none"), nullptr);
    EXPECT_THROW(json.at("none"), std::out_of_range);
    EXPECT_EQ(json.value("scene", size_t{7}), 7u);
    json.set("scene", 1);
    EXPECT_EQ(json.value("scene", size_t{7}), 1u);
    EXPECT_EQ(json.text(), json.whole().dump());
    EXPECT_EQ(StageJson(json.whole()), json);
    EXPECT_EQ(json.members().back().first, "scene");
    EXPECT_EQ(StageJson().text(), "{}");
    EXPECT_THROW(const StageJson made(ordered_json::array()), std::invalid_argument);
}

TEST(StageJson, CountsItsMemory) {
    StageJson json = some_json();
    const auto bytes = [&](size_t member) { return json.sizes().at(member).second; };
    const uint64_t nodes = bytes(1), buffers = bytes(2);
    json.edit("buffers")[0] = std::string(100000, 'A');
    EXPECT_EQ(bytes(1), nodes);
    EXPECT_NEAR(static_cast<double>(bytes(2)), static_cast<double>(buffers) + 100000, 100);
    json.edit("nodes").push_back(json["nodes"][0]);
    EXPECT_GT(bytes(1), nodes);
}

// The spliced text is the same whether members are compared by address or by value.
TEST(StageJson, EditsOfADocumentLeaveAllOtherBytes) {
    const std::string text = test::kForeignStage;
    const StageJson original(stage::parse_document(text, "test"));
    StageJson edited = original;
    EXPECT_EQ(stage::spliced(text, original, edited), text);
    edited.edit("nodes")[0]["name"] = "Ground";
    std::string expected = text;
    expected.replace(expected.find("\"Floor\""), 7, "\"Ground\"");
    EXPECT_EQ(stage::spliced(text, original, edited), expected);
    edited.edit("buffers");
    EXPECT_EQ(stage::spliced(text, original, edited), expected) << "a copy that is equal";
    edited.set("extras", {{"by", "hand"}});
    edited.erase("animations");
    EXPECT_EQ(stage::spliced(text, original, edited), stage::spliced(text, original.whole(), edited.whole()));
}

TEST(StageJson, SavedFilesGoOnSharing) {
    const TemporaryFolder folder;
    stage::StageFile file = stage::read_stage_file(test::put_foreign_stage(folder.path));
    const StageJson opened = file.json;
    EXPECT_TRUE(opened.shares(file.saved->json, "buffers"));
    file.json.edit("nodes")[0]["name"] = "Ground";
    const StageJson edited = file.json;
    stage::save_stage_file(file, folder.path / "stage.gltf");
    for (const auto& [name, value] : edited.members()) EXPECT_TRUE(file.json.shares(edited, name)) << name;
    EXPECT_TRUE(file.json.shares(opened, "buffers"));
    const stage::StageFile again = stage::read_stage_file(folder.path / "stage.gltf");
    EXPECT_EQ(again.json, edited);
    EXPECT_FALSE(again.json.shares(edited, "buffers")) << "read anew";
    std::filesystem::create_directory(folder.path / "below");
    file.json.edit("buffers")[0]["uri"] = "data:,";
    const StageJson embedded = file.json;
    const stage::StageFile moved = stage::moved_to(file, folder.path / "below/stage.gltf");
    EXPECT_TRUE(moved.json.shares(embedded, "buffers")) << "names no file";
    EXPECT_FALSE(moved.json.shares(embedded, "nodes"));
}

}  // namespace
}  // namespace neuvv
