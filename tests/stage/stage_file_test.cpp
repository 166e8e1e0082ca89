#include "stage/file/stage_file.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "stage/file/gltf_container.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "tests/stage/stage_files.h"

namespace neuvv {
namespace {

struct StageFiles : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path at(const std::string& name) const { return folder.path / name; }
};

std::string word(size_t value) {
    std::string bytes;
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift);
    return bytes;
}

std::string chunk(const std::string& kind, const std::string& bytes) {
    return word(bytes.size()) + kind + bytes;
}

std::string glb(std::string json, const std::string& more) {
    while (json.size() % 4 != 0) json += ' ';
    const std::string chunks = chunk("JSON", json) + more;
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
}

std::string text_of_bytes(const std::vector<uint8_t>& bytes) {
    return {bytes.begin(), bytes.end()};
}

TEST_F(StageFiles, UneditedIsByteEqual) {
    const std::string bytes =
        glb(R"({"asset":{"version":"2.0"}}   )", chunk(std::string("BIN\0", 4), "12345678")) + "behind";
    write_text(at("a.glb"), bytes);
    write_text(at("a.gltf"), test::kForeignStage);
    for (const char* name : {"a.glb", "a.gltf"}) {
        stage::StageFile file = stage::read_stage_file(at(name));
        const std::string before = read_text(at(name));
        EXPECT_EQ(text_of_bytes(stage::stage_bytes(file)), before);
        stage::save_stage_file(file, at(name));
        EXPECT_EQ(read_text(at(name)), before);
    }
}

TEST_F(StageFiles, EditedGlbKeepsItsOtherChunksAndCounts) {
    const std::string more = chunk(std::string("BIN\0", 4), "12345678") + chunk("XTRA", "abcd");
    write_text(at("a.glb"), glb(R"({"asset":{"version":"2.0"},"n":1.0})", more) + "behind");
    stage::StageFile file = stage::read_stage_file(at("a.glb"));
    for (const char* name : {"x", "a longer one", ""}) {
        file.json.set("name", name);
        stage::save_stage_file(file, at("a.glb"));
        const std::string text = read_text(at("a.glb"));
        EXPECT_EQ(text,
                  glb(std::string(R"({"asset":{"version":"2.0"},"n":1.0,"name":")") + name + "\"}", more) + "behind");
    }
    EXPECT_EQ(stage::read_stage_file(at("a.glb")).json["name"], "");
    EXPECT_EQ(folder.entries(), 1u) << "no temporary file";
}

TEST_F(StageFiles, InAnotherFolderItNamesTheSameFiles) {
    std::filesystem::create_directories(at("project/deep"));
    const std::string text = R"({"asset":{"version":"2.0"},"buffers":[{"uri":"deep/a%20b.bin","byteLength":4},
 {"uri":"data:,x","byteLength":1}],
"scenes":[{"extensions":{"NEUVV_stage":{"environment":{"uri":"../sky.png"}}}}],
"nodes":[{"extensions":{"NEUVV_performer":{"uri":"../captures/an%23na.nvv","paint":[{"uri":"red.nvpaint"}],"skeleton":{"uri":"b.glb"},"sound":{"uri":"../a.wav"}}}}]})";
    write_text(at("project/s.gltf"), text);
    stage::StageFile file = stage::read_stage_file(at("project/s.gltf"));
    stage::save_stage_file(file, at("up.gltf"));
    EXPECT_EQ(file.path, at("up.gltf"));
    const auto json = stage::read_stage_file(at("up.gltf")).json;
    EXPECT_EQ(json["buffers"][0]["uri"], "project/deep/a%20b.bin");
    EXPECT_EQ(json["buffers"][1]["uri"], "data:,x");
    EXPECT_EQ(json["scenes"][0]["extensions"]["NEUVV_stage"]["environment"]["uri"], "sky.png");
    const auto& performer = json["nodes"][0]["extensions"]["NEUVV_performer"];
    EXPECT_EQ(performer["uri"], "captures/an%23na.nvv");
    EXPECT_EQ(performer["paint"][0]["uri"], "project/red.nvpaint");
    EXPECT_EQ(performer["skeleton"]["uri"], "project/b.glb");
    EXPECT_EQ(performer["sound"]["uri"], "a.wav");
    stage::save_stage_file(file, at("project/s.gltf"));
    EXPECT_EQ(read_text(at("project/s.gltf")), text) << "there and back";
    expect_input_error([&] { stage::save_stage_file(file, at("other/in.gltf")); },
                       {"/buffers/0/uri", "outside", ".glb"});
    EXPECT_FALSE(std::filesystem::exists(at("other/in.gltf")));
}

TEST_F(StageFiles, ContainersKeepTheirEnding) {
    write_text(at("a.gltf"), R"({"asset":{"version":"2.0"}})");
    stage::StageFile file = stage::read_stage_file(at("a.gltf"));
    expect_input_error([&] { stage::save_stage_file(file, at("a.glb")); }, {"a.glb", "is a .gltf"});
    stage::StageFile made = stage::make_stage_file(at("b.glb"), R"({"asset":{"version":"2.0"}})");
    stage::save_stage_file(made, at("b.glb"));
    EXPECT_NO_THROW(stage::load_gltf(at("b.glb")));
    expect_input_error([&] { stage::save_stage_file(made, at("b.gltf")); }, {"b.gltf", "is a .glb"});
}

TEST_F(StageFiles, UrisNameFilesOnTheWayFromTheStage) {
    stage::StageFile file;
    file.path = at("project/s.gltf");
    EXPECT_EQ(stage::file_of_uri(file, "../a%20b.nvv", "p").lexically_normal(), at("a b.nvv"));
    EXPECT_EQ(stage::uri_of_file(file, at("a b#.nvv")), "../a%20b%23.nvv");
    EXPECT_EQ(stage::file_of_uri(file, stage::uri_of_file(file, at("50%.nvv")), "p").lexically_normal(), at("50%.nvv"));
    for (const char* uri :
         {"", "/etc/passwd", "%2fetc/passwd", "http://a/b.nvv", "file:a.nvv", "C:\\a.nvv", "a\\b.nvv", "a%00.nvv"})
        expect_input_error([&] { stage::file_of_uri(file, uri, "/nodes/0"); }, {"s.gltf", "/nodes/0", "../captures/"});
}

// File names are any bytes, JSON is UTF-8.
TEST_F(StageFiles, UrisNameFilesWhoseNamesAreNoUtf8) {
    for (const std::string name :
         {"b\xff d.nvv", "\xed\xa0\x80.nvv", "\xc3", "\xc0\xaf", "\xf4\x90\x80\x80", "\xe2\x82"}) {
        EXPECT_FALSE(is_utf8(name));
        EXPECT_TRUE(is_utf8(stage::encoded_uri(name)));
        EXPECT_EQ(stage::decoded_uri(stage::encoded_uri(name)), name);
    }
    for (const std::string name : {"Zoë.nvv", "舞.nvv", "\xf4\x8f\xbf\xbf"}) EXPECT_EQ(stage::encoded_uri(name), name);
    stage::StageFile file = stage::make_stage_file(at("new.gltf"), R"({"asset":{"version":"2.0"}})");
    file.json.edit("nodes") = {{{"name", "b\xff"}}};
    expect_input_error([&] { stage::save_stage_file(file, at("new.gltf")); }, {"new.gltf", "not UTF-8"});
}

TEST_F(StageFiles, APerformerMayPlayWhatIsAtAnAddress) {
    const std::string address = "https://example.com/a%20b/anna.nvs?key=1:2";
    write_text(at("s.gltf"), R"({"asset":{"version":"2.0"},"nodes":[{"extensions":{"NEUVV_performer":{"uri":")" +
                                 address + R"("}}}]})");
    stage::StageFile file = stage::read_stage_file(at("s.gltf"));
    EXPECT_EQ(stage::file_or_address_of_uri(file, address, "p"), address);
    EXPECT_EQ(stage::uri_of_file_or_address(file, address), address);
    EXPECT_EQ(stage::file_or_address_of_uri(file, "../a.nvv", "p"), stage::absolute_path(at("../a.nvv")));
    EXPECT_EQ(stage::uri_of_file_or_address(file, at("a.nvv")), "a.nvv");
    for (const char* uri : {"ftp://example.com/a.nvs", "file:a.nvs", "/etc/passwd"})
        expect_input_error([&] { stage::file_or_address_of_uri(file, uri, "/nodes/0"); }, {"s.gltf", "/nodes/0"});
    std::filesystem::create_directories(at("other"));
    stage::save_stage_file(file, at("other/s.gltf"));
    const auto json = stage::read_stage_file(at("other/s.gltf")).json;
    EXPECT_EQ(json["nodes"][0]["extensions"]["NEUVV_performer"]["uri"], address);
}

TEST_F(StageFiles, WhatIsNoStageIsRefused) {
    const auto refused = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
        write_text(at("x.gltf"), bytes);
        expect_input_error([&] { stage::read_stage_file(at("x.gltf")); }, parts);
    };
    refused("", {"x.gltf", "JSON"});
    refused("[]", {"x.gltf", "object"});
    refused("glTF", {"header"});
    refused(glb("{}", "").substr(0, 21), {"cut off"});
    refused(R"({"a":1,"a":1})", {"twice"});
    expect_input_error([&] { stage::read_stage_file(at("none.gltf")); }, {"none.gltf"});
    for (const char* address : {"https://example.com/show.gltf", "http://127.0.0.1/show.glb"})
        expect_input_error([&] { stage::read_stage_file(address); }, {address, "stages are read from files alone"});
}

}  // namespace
}  // namespace neuvv
