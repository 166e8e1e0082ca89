// Layers in a document: what a performer wears, free names, and painting that is undone.
#include "tools/viewer/layer_list.h"

#include <gtest/gtest.h>

#include "edit/operations.h"
#include "tests/stage/stage_files.h"
#include "tools/viewer/editor.h"
#include "voctree/nvpaint.h"

namespace neuvv {
namespace {

struct Layers : testing::Test {
    TemporaryFolder folder;
    Document document;
    uint32_t anna = 0;
    PaintedField field;

    void SetUp() override {
        document.file = read_stage_file(test::put_foreign_stage(folder.path));
        anna = find_node(document.file, "Anna");
        field = painted_field(read_nvv(folder.path / "anna.nvv"));
    }
    std::shared_ptr<const EditLayer> layer(float red) const {
        return std::make_shared<const EditLayer>(EditLayer{field, {{0, 0, 1, {red, 0, 0}, 1}}});
    }
    std::filesystem::path at(const char* name) const { return absolute_path(folder.path / name); }
};

TEST_F(Layers, AreListedAsThePerformerWearsThem) {
    const size_t worn = layers_of(document.file, anna)->size();
    add_paint_layer(document.file, anna, folder.path / "one.nvpaint", {.opacity = 0.25});
    add_paint_layer(document.file, anna, folder.path / "two.nvpaint", {.name = "look", .visible = false});
    const auto layers = layers_of(document.file, anna);
    ASSERT_TRUE(layers);
    ASSERT_EQ(layers->size(), worn + 2);
    EXPECT_EQ((*layers)[worn].path, at("one.nvpaint"));
    EXPECT_EQ((*layers)[worn].entry.opacity, 0.25);
    EXPECT_EQ(title_of((*layers)[worn]), "one");
    EXPECT_EQ(title_of((*layers)[worn + 1]), "look");
    EXPECT_FALSE((*layers)[worn + 1].entry.visible);
    const auto nodes = document.file.json["nodes"].size();
    EXPECT_FALSE(layers_of(document.file, static_cast<uint32_t>(nodes)));
    size_t performers = 0;
    for (uint32_t node = 0; node < nodes; node++) performers += layers_of(document.file, node).has_value();
    EXPECT_GT(performers, 0u);
    EXPECT_LT(performers, nodes) << "not all nodes are performers";
}

TEST_F(Layers, GetNamesThatNobodyHas) {
    rename_node(document.file, anna, "An/na B.");
    EXPECT_EQ(free_paint_path(document, anna), at("An-na-B-.nvpaint"));
    write_paint(at("An-na-B-.nvpaint"), *layer(1));
    EXPECT_EQ(free_paint_path(document, anna), at("An-na-B--2.nvpaint")) << "one is on the disk";
    document.paint[at("An-na-B--2.nvpaint")] = layer(1);
    EXPECT_EQ(free_paint_path(document, anna), at("An-na-B--3.nvpaint")) << "one is in the document";
    add_paint_layer(document.file, anna, at("An-na-B--3.nvpaint"), {});
    EXPECT_EQ(free_paint_path(document, anna), at("An-na-B--4.nvpaint")) << "one is worn";
}

TEST_F(Layers, ThatAreSharedBecomeOnesOwn) {
    const size_t worn = layers_of(document.file, anna)->size();
    add_paint_layer(document.file, anna, at("one.nvpaint"), {.name = "look", .opacity = 0.25});
    add_paint_layer(document.file, anna, at("two.nvpaint"), {});
    EXPECT_FALSE(is_shared(document.file, anna, at("one.nvpaint")));
    duplicate_node(document.file, anna, CopySettings{});
    const auto copy = static_cast<uint32_t>(document.file.json["nodes"].size() - 1);
    EXPECT_TRUE(is_shared(document.file, anna, at("one.nvpaint")));
    EXPECT_TRUE(is_shared(document.file, copy, at("one.nvpaint")));

    const auto before = layers_of(document.file, anna).value();
    own_paint(document, copy, worn, at("own.nvpaint"), layer(0.5f));
    const auto after = layers_of(document.file, copy).value();
    ASSERT_EQ(after.size(), before.size());
    for (size_t i = 0; i < after.size(); i++) {
        EXPECT_EQ(after[i].path, i == worn ? at("own.nvpaint") : before[i].path) << i;
        EXPECT_EQ(after[i].entry.opacity, before[i].entry.opacity) << i;
    }
    EXPECT_EQ(title_of(after[worn]), "look");
    EXPECT_EQ(layers_of(document.file, anna)->at(worn).path, at("one.nvpaint"));
    EXPECT_FALSE(is_shared(document.file, copy, at("own.nvpaint")));
    EXPECT_EQ(document.paint.at(at("own.nvpaint"))->edits.size(), 1u);
}

TEST_F(Layers, ThatWerePaintedAreUndone) {
    Editor editor;
    const size_t worn = layers_of(document.file, anna)->size();
    write_paint(at("disk.nvpaint"), *layer(0.125f));
    add_paint_layer(document.file, anna, at("disk.nvpaint"), {});
    editor.open(document, false);
    const auto paint = [&](const char* file, std::shared_ptr<const EditLayer> painted) {
        return [=, this](Document& edited) { return put_paint(edited, anna, at(file), "new", painted, "painted"); };
    };
    const auto before = std::make_shared<const EditLayer>(read_paint(at("disk.nvpaint"), field));
    editor.open_layer(at("disk.nvpaint"), before);
    EXPECT_FALSE(editor.modified()) << "reading is no edit";
    const auto half = layer(0.5f), whole = layer(1);
    ASSERT_TRUE(editor.drag(paint("disk.nvpaint", half)));
    ASSERT_TRUE(editor.drag(paint("disk.nvpaint", whole)));
    editor.end_drag();
    EXPECT_EQ(editor.document().paint.at(at("disk.nvpaint")), whole);
    EXPECT_EQ(layers_of(editor.file(), anna)->size(), worn + 1) << "it is worn already";

    Document saved = editor.document();
    save_document(saved, saved.file.path);
    editor.saved(saved, editor.opened(), editor.id());
    EXPECT_FALSE(editor.modified());
    EXPECT_EQ(read_paint(at("disk.nvpaint"), field).edits, whole->edits);
    editor.undo();
    EXPECT_EQ(editor.document().paint.at(at("disk.nvpaint")), before) << "one step, as it was before the stroke";
    EXPECT_TRUE(editor.modified());
    editor.redo();
    EXPECT_EQ(editor.document().paint.at(at("disk.nvpaint")), whole);

    ASSERT_TRUE(editor.edit(paint("fresh.nvpaint", half)));
    EXPECT_EQ(layers_of(editor.file(), anna)->size(), worn + 2);
    EXPECT_EQ(title_of(layers_of(editor.file(), anna)->back()), "new");
    editor.undo();
    EXPECT_EQ(layers_of(editor.file(), anna)->size(), worn + 1) << "the layer is gone with the stroke";
}

}  // namespace
}  // namespace neuvv
