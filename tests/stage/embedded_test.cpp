#include "stage/gltf/embedded.h"

#include <gtest/gtest.h>

#include "stage/stage.h"
#include "tests/stage/stage_files.h"

namespace neuvv {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), with);
}

// The stage with three buffers, of which the last one has the camera's path, and with a file as its image.
std::filesystem::path put_stage_of_files(const std::filesystem::path& folder) {
    std::filesystem::path stage = test::put_foreign_stage(folder);
    std::string text = read_text(stage);
    const size_t begin = text.find("data:image/png"), end = text.find('"', begin);
    text.replace(begin, end - begin, "wood%201.png");
    for (size_t at = 0; (at = text.find("\"buffer\" : 0", at)) != std::string::npos;) text[at + 11] = '1';
    text = replaced(text, R"({ "buffer" : 1, "byteLength" : 24, "byteOffset" : 104 })",
                    R"({ "buffer" : 2, "byteLength" : 24 })");
    text = replaced(text, R"("buffers" : [)", R"("buffers" : [ { "byteLength" : 105, "uri" : "first.bin" },)");
    text =
        replaced(text, R"("stage%20data.bin" })", R"("stage%20data.bin" }, { "byteLength" : 24, "uri" : "path.bin" })");
    write_text(stage, text);
    write_text(folder / "first.bin", std::string(105, 'x'));  // what follows is to be aligned
    write_text(folder / "path.bin", test::foreign_buffer().substr(104, 24));
    media::Image wood(2, 1);
    wood.rgba = {255, 0, 0, 255, 0, 255, 0, 255};
    media::write_png(folder / "wood 1.png", wood);
    return stage;
}

TEST(Embedded, HoldsTheFilesBesideADocument) {
    const TemporaryFolder folder;
    const std::filesystem::path source = put_stage_of_files(folder.path / "source"),
                                output = folder.path / "elsewhere/all.glb";
    std::filesystem::create_directories(output.parent_path());
    const stage::Stage before = stage::load_stage(source);
    stage::embedded(stage::read_stage_file(source), output).write(output, "");
    for (const char* name : {"first.bin", "stage data.bin", "path.bin", "wood 1.png"})
        std::filesystem::remove(source.parent_path() / name);
    const stage::Stage after = stage::load_stage(output);
    EXPECT_EQ(after.file.json["buffers"].size(), 1u);
    EXPECT_FALSE(after.file.json["images"][0].contains("uri"));
    const auto positions = [](const stage::Stage& stage) { return stage.scene.meshes[0].primitives[0].positions; };
    EXPECT_EQ(positions(after), positions(before));
    EXPECT_EQ(after.scene.animations[0].channels[0].values, before.scene.animations[0].channels[0].values);
    EXPECT_EQ(after.scene.images[0]->pixels.rgba, before.scene.images[0]->pixels.rgba);
    EXPECT_EQ(after.scene.images[0]->pixels.rgba[5], 255) << "the second texel is green";
    EXPECT_EQ(after.clips[0].path, before.clips[0].path);
    EXPECT_EQ(after.file.json["extensions"]["ACME_fog"], before.file.json["extensions"]["ACME_fog"]);
}

TEST(Embedded, OfAFileThatHoldsAllIsTheSame) {
    const TemporaryFolder folder;
    const std::filesystem::path first = folder.path / "first.glb", second = folder.path / "second.glb";
    stage::embedded(stage::read_stage_file(put_stage_of_files(folder.path)), first).write(first, "");
    stage::embedded(stage::read_stage_file(first), second).write(second, "");
    EXPECT_EQ(read_text(second), read_text(first));
}

TEST(Embedded, TakesImagesOfADocumentWithoutBuffers) {
    const TemporaryFolder folder;
    media::Image wood(2, 1);
    wood.rgba = {255, 0, 0, 255, 0, 255, 0, 255};
    media::write_png(folder.path / "wood.png", wood);
    std::string more;
    for (int members = 0; members < 8; ++members) {
        const std::filesystem::path source = folder.path / "a.gltf", output = folder.path / "a.glb";
        write_text(source, R"({"asset": {"version": "2.0"}, "images": [{"uri": "wood.png"}, {"uri": "wood.png"}])" +
                               more + "}");
        stage::embedded(stage::read_stage_file(source), output).write(output, "");
        const stage::StageFile file = stage::read_stage_file(output);
        EXPECT_EQ(file.json["images"][1]["bufferView"], 1) << members;
        EXPECT_EQ(file.json["bufferViews"].size(), 2u);
        more += R"(, "m)" + std::to_string(members) + R"(": 0)";
    }
}

TEST(Embedded, MayBeWithoutBuffers) {
    const TemporaryFolder folder;
    const std::filesystem::path source = folder.path / "a.gltf", output = folder.path / "a.glb";
    write_text(source, R"({"asset": {"version": "2.0"}, "nodes": [{"name": "alone"}]})");
    stage::embedded(stage::read_stage_file(source), output).write(output, "");
    EXPECT_EQ(stage::load_gltf(output).nodes.at(0).name, "alone");
}

}  // namespace
}  // namespace neuvv
