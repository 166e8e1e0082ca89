#include "editor/editor.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "edit/operations.h"
#include "edit/paint_layers.h"
#include "editor/stage_state.h"
#include "tests/stage/stage_files.h"
#include "voctree/files/nvpaint.h"

namespace neuvv {
namespace {

std::filesystem::path in_temp(const char* name) {
    return std::filesystem::path(testing::TempDir()) / name;
}

edit::Document stage_named(const char* name) {
    return {edit::new_stage(in_temp(name)), {}, {}};
}

editor::Editor::Operation named(uint32_t node, const std::string& name) {
    return [=](edit::Document& document) { return edit::rename_node(document.file, node, name); };
}

std::string name_of(const editor::Editor& editor, uint32_t node) {
    return edit::name_of(editor.file(), node);
}

const editor::Editor::Operation kRefused = [](edit::Document&) -> std::string { throw InputError("stage", "", "no"); };

TEST(Editor, ADragIsOneStepFromWhereItBegan) {
    editor::Editor editor;
    editor.open(stage_named("a.gltf"), false);
    const std::string before = name_of(editor, 0);
    for (const char* name : {"x", "xy", "xyz"}) ASSERT_TRUE(editor.drag(named(0, name)));
    EXPECT_FALSE(editor.modified()) << "while it goes on";
    editor.end_drag();
    EXPECT_EQ(name_of(editor, 0), "xyz");
    EXPECT_TRUE(editor.modified());
    editor.undo();
    EXPECT_EQ(name_of(editor, 0), before);
    EXPECT_FALSE(editor.modified());
}

TEST(Editor, WhatIsRefusedLeavesNoStep) {
    editor::Editor editor;
    editor.open(stage_named("a.gltf"), false);
    EXPECT_FALSE(editor.edit(kRefused));
    EXPECT_FALSE(editor.drag(kRefused));
    EXPECT_FALSE(editor.dragging());
    editor.end_drag();
    EXPECT_EQ(editor.history().next_undo(), nullptr);
    EXPECT_EQ(editor.take_notices().size(), 1u) << "the same is told once";
}

TEST(Editor, WhatCannotBeDrawnIsTakenBack) {
    editor::Editor editor;
    editor.open(stage_named("a.gltf"), false);
    const std::string before = name_of(editor, 0);
    ASSERT_TRUE(editor.edit(named(0, "wrong")));
    editor.take_back("it cannot be drawn");
    EXPECT_EQ(name_of(editor, 0), before);
    ASSERT_TRUE(editor.drag(named(0, "wrong")));
    editor.take_back("it cannot be drawn");
    EXPECT_FALSE(editor.dragging());
    EXPECT_EQ(name_of(editor, 0), before);
}

TEST(Editor, ASaveKeepsWhatWasEditedMeanwhile) {
    editor::Editor editor;
    editor.open(stage_named("a.gltf"), false);
    ASSERT_TRUE(editor.edit(named(0, "first")));
    edit::Document saved = editor.document();
    const uint64_t id = editor.id();
    ASSERT_TRUE(editor.edit(named(0, "second")));
    ASSERT_TRUE(editor.drag(named(1, "held")));
    edit::save_document(saved, in_temp("b.gltf"));
    editor.saved(saved, editor.open_count(), id);
    EXPECT_EQ(editor.file().path, in_temp("b.gltf"));
    ASSERT_TRUE(editor.drag(named(1, "held longer")));
    editor.end_drag();
    EXPECT_EQ(editor.file().path, in_temp("b.gltf")) << "the drag began before the save";
    EXPECT_EQ(name_of(editor, 0), "second");
    EXPECT_TRUE(editor.modified());
}

TEST(Editor, ASaveOfAnotherDocumentIsNotThisOnes) {
    editor::Editor editor;
    editor.open(stage_named("a.gltf"), false);
    edit::Document saved = editor.document();
    const uint64_t number = editor.open_count(), id = editor.id();
    editor.open(stage_named("new.gltf"), true);
    edit::save_document(saved, in_temp("a.gltf"));
    editor.saved(saved, number, id);
    EXPECT_EQ(editor.file().path, in_temp("new.gltf"));
    EXPECT_FALSE(editor.file().saved->on_disk);
    EXPECT_TRUE(editor.modified());
}

TEST(Editor, NumbersOfNodesThatMayMeanOthersAreNotSelected) {
    editor::Editor editor;
    editor.open(stage_named("a.gltf"), false);
    ASSERT_GE(editor.node_count(), 3u);
    ASSERT_TRUE(editor.edit([](edit::Document& document) { return edit::remove_node(document.file, 0); }));
    editor.select(1);
    editor.undo();
    EXPECT_FALSE(editor.selected().has_value());
    ASSERT_TRUE(editor.edit(named(0, "same nodes")));
    editor.select(1);
    editor.undo();
    EXPECT_EQ(editor.selected(), 1u);
}

TEST(Editor, FrozenItTellsWhy) {
    editor::Editor editor;
    editor.open(stage_named("a.gltf"), false);
    editor.freeze("busy");
    EXPECT_FALSE(editor.edit(named(0, "x")));
    EXPECT_FALSE(editor.drag(named(0, "x")));
    ASSERT_EQ(editor.take_notices().size(), 1u);
    editor.freeze({});
    EXPECT_TRUE(editor.edit(named(0, "x")));
}

TEST(Editor, WhatAFileHasThatIsNotShownIsReportedOnce) {
    editor::StageState state;
    const auto notices = [&] {
        std::vector<std::string> texts;
        state.follow_document();
        for (const editor::Notice& notice : state.editor.take_notices()) texts.push_back(notice.text);
        return texts;
    };
    const auto with_scenes = [](const char* name) {
        return edit::Document{stage::make_stage_file(in_temp(name), R"({"asset": {"version": "2.0"}, "scene": 0,
            "scenes": [{"nodes": [0]}, {}], "nodes": [{"name": "anna"}]})"),
                              {},
                              {}};
    };
    state.editor.open(with_scenes("two.gltf"), false);
    EXPECT_EQ(notices(), std::vector<std::string>{"two.gltf shows its scene 0 alone; it has 2"});
    ASSERT_TRUE(state.editor.edit(named(0, "berta")));
    for (const std::string& text : notices()) EXPECT_EQ(text.find("two.gltf"), std::string::npos) << text;
    state.editor.open(with_scenes("other.gltf"), false);
    state.editor.stage_made(*state.stage, 1);  // of the document before, read late
    EXPECT_EQ(notices(), std::vector<std::string>{"other.gltf shows its scene 0 alone; it has 2"});
    state.editor.open(stage_named("whole.gltf"), false);
    EXPECT_TRUE(notices().empty());
}

TEST(Editor, LayersThatWerePaintedAreUndone) {
    const TemporaryFolder folder;
    edit::Document document;
    document.file = stage::read_stage_file(test::put_foreign_stage(folder.path));
    const uint32_t anna = edit::find_node(document.file, "Anna");
    const voctree::PaintedField field = voctree::painted_field(voctree::read_nvv(folder.path / "anna.nvv"));
    const auto at = [&](const char* name) { return stage::absolute_path(folder.path / name); };
    const auto layer = [&](float red) {
        return std::make_shared<const voctree::EditLayer>(voctree::EditLayer{field, {{0, 0, 1, {red, 0, 0}, 1}}});
    };
    editor::Editor editor;
    const size_t used = edit::paint_layers_of(document.file, anna)->size();
    voctree::write_paint(at("disk.nvpaint"), *layer(0.125f));
    edit::add_paint_layer(document.file, anna, at("disk.nvpaint"), {});
    editor.open(document, false);
    const auto paint = [&](const char* file, const std::shared_ptr<const voctree::EditLayer>& painted) {
        return [path = at(file), anna, painted](edit::Document& edited) {
            return edit::set_paint(edited, anna, path, "new", {{path, painted}}, "painted");
        };
    };
    const auto before = std::make_shared<const voctree::EditLayer>(voctree::read_paint(at("disk.nvpaint"), field));
    editor.open_layer(at("disk.nvpaint"), before);
    EXPECT_FALSE(editor.modified()) << "reading is no edit";
    const auto half = layer(0.5f), whole = layer(1);
    ASSERT_TRUE(editor.drag(paint("disk.nvpaint", half)));
    ASSERT_TRUE(editor.drag(paint("disk.nvpaint", whole)));
    editor.end_drag();
    EXPECT_EQ(editor.document().paint.at(at("disk.nvpaint")), whole);
    EXPECT_EQ(edit::paint_layers_of(editor.file(), anna)->size(), used + 1) << "it is used already";

    edit::Document saved = editor.document();
    edit::save_document(saved, saved.file.path);
    editor.saved(saved, editor.open_count(), editor.id());
    EXPECT_FALSE(editor.modified());
    EXPECT_EQ(voctree::read_paint(at("disk.nvpaint"), field).edits, whole->edits);
    editor.undo();
    EXPECT_EQ(editor.document().paint.at(at("disk.nvpaint")), before) << "one step, as it was before the stroke";
    EXPECT_TRUE(editor.modified());
    editor.redo();
    EXPECT_EQ(editor.document().paint.at(at("disk.nvpaint")), whole);

    ASSERT_TRUE(editor.edit(paint("fresh.nvpaint", half)));
    EXPECT_EQ(edit::paint_layers_of(editor.file(), anna)->size(), used + 2);
    EXPECT_EQ(edit::title_of(edit::paint_layers_of(editor.file(), anna)->back()), "new");
    editor.undo();
    EXPECT_EQ(edit::paint_layers_of(editor.file(), anna)->size(), used + 1) << "the layer is gone with the stroke";
}

}  // namespace
}  // namespace neuvv
