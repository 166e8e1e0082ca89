#include "edit/history.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file_lock.h"
#include "edit/operations.h"
#include "edit/paint_layers.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "tests/edit/foreign_stage.h"
#include "voctree/files/nvpaint.h"

namespace neuvv {
namespace {

using nlohmann::ordered_json;

struct Histories : test::ForeignDocument {
    // A layer in which so many leaves have this red.
    std::shared_ptr<const voctree::EditLayer> layer(float red, uint32_t leaves = 1) const {
        auto made = std::make_shared<voctree::EditLayer>(voctree::EditLayer{field, {}});
        for (uint32_t leaf = 0; leaf < leaves; ++leaf) made->edits.push_back({leaf, 0, 1, {red, 0, 0}, 1});
        return made;
    }
    float red_on_disk(const std::string& name) const {
        return voctree::read_paint(at(name), field).edits.at(0).colour.r;
    }
    float red(const std::string& name) const { return document.paint.at(at(name))->edits.at(0).colour.r; }
    void rename(edit::History& history, const std::string& name, uint32_t node = 4) {
        edit::Document before = document;
        std::string said = edit::rename_node(document.file, node, name);
        history.add_step(std::move(before), document, std::move(said));
    }
    void stroke(edit::History& history, const std::string& name, float colour, uint32_t leaves = 1) {
        edit::open_paint(document, at(name), field);
        edit::Document before = document;
        document.paint[at(name)] = layer(colour, leaves);
        history.add_step(std::move(before), document, "stroke");
    }
    // The document with a layer of Anna's, both on the disk.
    void wear(const std::string& name, float colour) {
        voctree::write_paint(at(name), *layer(colour));
        edit::add_paint_layer(document.file, edit::find_node(document.file, "Anna"), at(name), {});
    }
};

TEST_F(Histories, GoBackAndForth) {
    edit::History history(3);
    std::vector<stage::StageJson> documents = {document.file.json};
    for (int i = 0; i < 5; ++i) {
        rename(history, "name " + std::to_string(i));
        documents.push_back(document.file.json);
    }
    EXPECT_FALSE(history.redo(document));
    EXPECT_EQ(history.next_redo(), nullptr);
    for (size_t i = 5; i > 2; --i) {
        ASSERT_TRUE(history.next_undo());
        const std::string next = *history.next_undo();
        const auto what = history.undo(document);
        ASSERT_TRUE(what);
        EXPECT_EQ(*what, next);
        EXPECT_EQ(*history.next_redo(), next);
        EXPECT_NE(what->find("name " + std::to_string(i - 1)), std::string::npos);
        EXPECT_EQ(document.file.json, documents[i - 1]);
    }
    EXPECT_FALSE(history.undo(document)) << "three steps are kept";
    EXPECT_TRUE(history.redo(document));
    EXPECT_EQ(document.file.json, documents[3]);
    rename(history, "elsewhere");
    EXPECT_FALSE(history.redo(document)) << "another way was taken";
    EXPECT_TRUE(history.undo(document));
    EXPECT_EQ(document.file.json, documents[3]);
}

TEST_F(Histories, KnowWhetherTheDocumentIsTheSavedOne) {
    edit::History history;
    EXPECT_FALSE(history.is_modified());
    rename(history, "a");
    const uint64_t a = history.revision();
    EXPECT_TRUE(history.is_modified());
    history.mark_saved();
    EXPECT_FALSE(history.is_modified());
    rename(history, "b");
    history.undo(document);
    EXPECT_EQ(history.revision(), a);
    EXPECT_FALSE(history.is_modified()) << "back at what was saved";
    history.undo(document);
    EXPECT_TRUE(history.is_modified());
    history.redo(document);
    EXPECT_FALSE(history.is_modified());
    history.undo(document);
    rename(history, "c");
    EXPECT_TRUE(history.is_modified());
    EXPECT_NE(history.revision(), a) << "another state, however it was reached";
    history.mark_saved();
    history.mark_unsaved();
    EXPECT_TRUE(history.is_modified());
}

TEST_F(Histories, PaintAndStageShareOneList) {
    wear("red.nvpaint", 0.25f);
    edit::History history;
    rename(history, "Berta");  // before the layer is opened
    stroke(history, "red.nvpaint", 0.5f);
    rename(history, "Carla");
    const stage::StageJson carla = document.file.json;
    stroke(history, "red.nvpaint", 0.75f);
    edit::save_document(document, at("stage.gltf"));
    EXPECT_EQ(red_on_disk("red.nvpaint"), 0.75f);
    EXPECT_EQ(history.undo(document), "stroke");
    EXPECT_EQ(red("red.nvpaint"), 0.5f);
    EXPECT_EQ(document.file.json, carla);
    history.undo(document);
    EXPECT_EQ(red("red.nvpaint"), 0.5f);
    history.undo(document);
    EXPECT_EQ(red("red.nvpaint"), 0.25f);
    history.undo(document);
    EXPECT_FALSE(history.next_undo());
    EXPECT_EQ(edit::find_node(document.file, "Anna"), 4u);
    EXPECT_EQ(red("red.nvpaint"), 0.25f) << "what was there before the layer was opened, though the disk has another";
    edit::save_document(document, at("stage.gltf"));
    EXPECT_EQ(red_on_disk("red.nvpaint"), 0.25f);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(history.redo(document));
    EXPECT_EQ(red("red.nvpaint"), 0.75f);
    EXPECT_EQ(document.file.json, carla);
}

// Strokes of two layers share what they did not change, and the bytes that only undo needs are bounded.
TEST_F(Histories, ForgetTheOldestWhereLayersGrow) {
    wear("red.nvpaint", 0);
    wear("blue.nvpaint", 0);
    edit::open_paint(document, at("blue.nvpaint"), field);
    constexpr uint32_t kLeaves = 20;
    edit::History history(100, 3 * kLeaves * sizeof(voctree::LeafEdit));
    for (int i = 1; i <= 10; ++i) stroke(history, "red.nvpaint", static_cast<float>(i) / 10, kLeaves);
    int steps = 0;
    while (history.undo(document)) ++steps;
    EXPECT_EQ(steps, 3);
    EXPECT_EQ(red("red.nvpaint"), 0.7f);
    edit::History tiny(100, 1);
    stroke(tiny, "red.nvpaint", 0.9f, kLeaves);
    EXPECT_TRUE(tiny.next_undo()) << "the last step stays";
    constexpr uint32_t kManyLeaves = 100000;
    document.paint[at("red.nvpaint")] = layer(0.9f, kManyLeaves);
    edit::History names(100, kManyLeaves * sizeof(voctree::LeafEdit) / 2);
    for (int i = 0; i < 10; ++i) rename(names, "name " + std::to_string(i));
    for (steps = 0; names.undo(document);) ++steps;
    EXPECT_EQ(steps, 10) << "none of these holds a layer of its own";
}

TEST_F(Histories, UrisFollowTheStageToAnotherFolder) {
    write_text(at("new.gltf"), R"({"asset":{"version":"2.0"},"scenes":[{}]})");
    document.file = stage::read_stage_file(at("new.gltf"));
    edit::History history;
    edit::Document before = document;
    edit::PerformerEdit edit;
    edit.clip = at("anna.nvv");
    history.add_step(std::move(before), document, edit::add_performer(document.file, "anna", edit, {}));
    edit::rename_node(document.file, 0, "berta");
    std::filesystem::create_directory(at("below"));
    edit::save_document(document, at("below/show.gltf"));
    history.undo(document);
    history.redo(document);
    EXPECT_EQ(document.file.path, at("below/show.gltf"));
    EXPECT_EQ(edit::clip_of(document.file, 0), stage::absolute_path(at("below/../anna.nvv")));
    EXPECT_EQ(stage::make_stage(document.file).performers[0].name, "berta");
    rename(history, "carla", 0);
    edit::save_document(document, at("show.gltf"));
    history.undo(document);
    EXPECT_EQ(edit::clip_of(document.file, 0), at("anna.nvv")) << "a step of before it was saved here";
}

TEST_F(Histories, SavingWritesWhatChanged) {
    wear("red.nvpaint", 0.25f);
    wear("blue.nvpaint", 0.25f);
    edit::save_document(document, at("stage.gltf"));
    EXPECT_NE(read_text(at("stage.gltf")).find("blue.nvpaint"), std::string::npos);
    edit::open_paint(document, at("red.nvpaint"), field);
    edit::open_paint(document, at("blue.nvpaint"), field);
    document.paint[at("red.nvpaint")] = layer(0.5f);
    document.paint[at("nobody's.nvpaint")] = layer(0.5f);
    write_text(at("blue.nvpaint"), "not looked at");
    edit::save_document(document, at("elsewhere.gltf"));
    EXPECT_EQ(red_on_disk("red.nvpaint"), 0.5f);
    EXPECT_EQ(read_text(at("blue.nvpaint")), "not looked at");
    EXPECT_FALSE(std::filesystem::exists(at("nobody's.nvpaint")));
    EXPECT_EQ(document.file.path, at("elsewhere.gltf"));
    EXPECT_EQ(stage::load_stage(at("elsewhere.gltf")).performers[0].settings.paint.size(), 2u);

    const uint32_t anna = edit::find_node(document.file, "Anna");
    edit::add_paint_layer(document.file, anna, at("new.nvpaint"), {});
    document.paint[edit::paint_path(document.file, "new.nvpaint")] = layer(1);
    edit::save_document(document, at("elsewhere.gltf"));
    EXPECT_EQ(red_on_disk("new.nvpaint"), 1) << "a layer that had no file";
    edit::PerformerEdit edit;
    edit.opacity = 2;
    edit::set_performer(document.file, anna, edit);
    document.paint[at("red.nvpaint")] = layer(0.75f);
    expect_input_error([&] { edit::save_document(document, at("elsewhere.gltf")); }, {"opacity"});
    EXPECT_EQ(red_on_disk("red.nvpaint"), 0.5f) << "nothing was written";
}

TEST_F(Histories, DamagedLayersAreNotOpened) {
    write_text(at("bad.nvpaint"), "no paint");
    expect_input_error([&] { edit::open_paint(document, at("bad.nvpaint"), field); }, {"bad.nvpaint"});
    expect_input_error([&] { edit::open_paint(document, at("none.nvpaint"), field); }, {"none.nvpaint"});
    EXPECT_TRUE(document.paint.empty() && document.saved_paint.empty());
}

TEST_F(Histories, SavingKeepsWhatAnotherProgramWrote) {
    edit::History history;
    rename(history, "Berta");
    EXPECT_TRUE(edit::save_document(document, at("stage.gltf")).empty());
    rename(history, "Carla");
    for (const char* kept : {"stage-theirs.gltf", "stage-theirs-2.gltf"}) {
        const std::string theirs = std::string(R"({"asset": {"version": "2.0"}, "extras": ")") + kept + "\"}";
        write_text(at("stage.gltf"), theirs);
        const auto versions = edit::save_document(document, at("stage.gltf"));
        ASSERT_EQ(versions.size(), 1u);
        EXPECT_EQ(versions[0].as, at(kept));
        EXPECT_EQ(read_text(at(kept)), theirs);
        EXPECT_EQ(edit::find_node(stage::read_stage_file(at("stage.gltf")), "Carla"), 4u);
        EXPECT_NE(edit::saved_text(at("stage.gltf"), versions).find(kept), std::string::npos);
    }
    std::filesystem::remove(at("stage.gltf"));
    EXPECT_TRUE(edit::save_document(document, at("stage.gltf")).empty()) << "what is gone needs no copy";
    write_text(at("other.gltf"), "{}");
    EXPECT_TRUE(edit::save_document(document, at("other.gltf")).empty())
        << "that another name is overwritten was asked";
    EXPECT_EQ(edit::saved_text("a.gltf", {}), "saved a.gltf");
}

TEST_F(Histories, SavingWaitsForAnotherProgramAsLongAsItIsTold) {
    wear("red.nvpaint", 0.25f);
    edit::History history;
    stroke(history, "red.nvpaint", 0.5f);
    const EditLock theirs(at("red.nvpaint"));
    std::vector<std::filesystem::path> asked;
    const auto twice = [&](const std::filesystem::path& file) {
        asked.push_back(file);
        return asked.size() < 2;
    };
    EXPECT_THROW(edit::save_document(document, at("stage.gltf"), twice), RuntimeFailure);
    EXPECT_EQ(asked, (std::vector<std::filesystem::path>{at("red.nvpaint"), at("red.nvpaint")}));
    EXPECT_EQ(red_on_disk("red.nvpaint"), 0.25f) << "what they edit stays";
}

// As by `neuvv paint` while the stage is open in the window.
TEST_F(Histories, SavingKeepsPaintOfAnotherProgram) {
    wear("red.nvpaint", 0.25f);
    edit::History history;
    stroke(history, "red.nvpaint", 0.5f);
    voctree::write_paint(at("red.nvpaint"), *layer(0.75f));
    const auto kept = edit::save_document(document, at("stage.gltf"));
    ASSERT_EQ(kept.size(), 1u);
    EXPECT_EQ(red_on_disk("red.nvpaint"), 0.5f);
    EXPECT_EQ(red_on_disk("red-theirs.nvpaint"), 0.75f);
    EXPECT_EQ(edit::saved_text("a.gltf", kept),
              "saved a.gltf; another program had changed red.nvpaint: its version is kept as red-theirs.nvpaint");
    stroke(history, "red.nvpaint", 1);
    EXPECT_TRUE(edit::save_document(document, at("stage.gltf")).empty()) << "now it is ours";
    write_text(at("red.nvpaint"), "of another clip");
    stroke(history, "red.nvpaint", 0.5f);
    EXPECT_EQ(edit::save_document(document, at("stage.gltf")).at(0).as, at("red-theirs-2.nvpaint"));
    EXPECT_EQ(read_text(at("red-theirs-2.nvpaint")), "of another clip");
}

TEST_F(Histories, SavingKeepsSegmentsOfAnotherProgram) {
    const std::filesystem::path look = at("look.nvpaint"), theirs = at("look-theirs.nvpaint");
    voctree::PaintLayers files;
    for (const char* segment : {"000000.nvpaint", "000012.nvpaint", "000024.nvpaint"}) {
        files[look / segment] = layer(0.5f);
        document.saved_paint[look / segment] = layer(0, 0);
    }
    edit::set_paint(document, 4, look, "look", files, "painted");
    for (const char* segment : {"000000.nvpaint", "000024.nvpaint"})
        voctree::write_segment_paint(look / segment, *layer(0.75f));
    const auto kept = edit::save_document(document, at("stage.gltf"));
    ASSERT_EQ(kept.size(), 1u) << "one folder";
    EXPECT_EQ(kept[0].as, theirs);
    for (const char* segment : {"000000.nvpaint", "000024.nvpaint"})
        EXPECT_EQ(voctree::read_paint(theirs / segment, field).edits, layer(0.75f)->edits);
    EXPECT_FALSE(std::filesystem::exists(theirs / "000012.nvpaint"));
    for (const auto& [file, painted] : files) EXPECT_EQ(voctree::read_paint(file, field).edits, painted->edits);
}

}  // namespace
}  // namespace neuvv
