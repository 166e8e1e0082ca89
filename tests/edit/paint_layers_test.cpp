// Layers in a document: which ones a performer uses, free names, and layers that are shared.
#include "edit/paint_layers.h"

#include <gtest/gtest.h>

#include "edit/operations.h"
#include "tests/stage/stage_files.h"
#include "voctree/files/nvpaint.h"

namespace neuvv {
namespace {

struct Layers : testing::Test {
    TemporaryFolder folder;
    edit::Document document;
    uint32_t anna = 0;
    voctree::PaintedField field;

    void SetUp() override {
        document.file = stage::read_stage_file(test::put_foreign_stage(folder.path));
        anna = edit::find_node(document.file, "Anna");
        field = voctree::painted_field(voctree::read_nvv(folder.path / "anna.nvv"));
    }
    std::shared_ptr<const voctree::EditLayer> layer(float red) const {
        return std::make_shared<const voctree::EditLayer>(voctree::EditLayer{field, {{0, 0, 1, {red, 0, 0}, 1}}});
    }
    std::filesystem::path at(const char* name) const { return stage::absolute_path(folder.path / name); }
};

TEST_F(Layers, AreListedAsThePerformerWearsThem) {
    const size_t used = edit::paint_layers_of(document.file, anna)->size();
    edit::add_paint_layer(document.file, anna, folder.path / "one.nvpaint", {.opacity = 0.25});
    edit::add_paint_layer(document.file, anna, folder.path / "two.nvpaint", {.name = "look", .visible = false});
    const auto layers = edit::paint_layers_of(document.file, anna);
    ASSERT_TRUE(layers);
    ASSERT_EQ(layers->size(), used + 2);
    EXPECT_EQ((*layers)[used].path, at("one.nvpaint"));
    EXPECT_EQ((*layers)[used].entry.opacity, 0.25);
    EXPECT_EQ(edit::title_of((*layers)[used]), "one");
    EXPECT_EQ(edit::title_of((*layers)[used + 1]), "look");
    EXPECT_FALSE((*layers)[used + 1].entry.visible);
    const auto nodes = document.file.json["nodes"].size();
    EXPECT_FALSE(edit::paint_layers_of(document.file, static_cast<uint32_t>(nodes)));
    size_t performers = 0;
    for (uint32_t node = 0; node < nodes; ++node) performers += edit::paint_layers_of(document.file, node).has_value();
    EXPECT_GT(performers, 0u);
    EXPECT_LT(performers, nodes) << "not all nodes are performers";
}

TEST_F(Layers, GetNamesThatNobodyHas) {
    edit::rename_node(document.file, anna, "An/na B.");
    EXPECT_EQ(edit::free_paint_path(document, anna), at("An-na-B-.nvpaint"));
    voctree::write_paint(at("An-na-B-.nvpaint"), *layer(1));
    EXPECT_EQ(edit::free_paint_path(document, anna), at("An-na-B--2.nvpaint")) << "one is on the disk";
    document.paint[at("An-na-B--2.nvpaint")] = layer(1);
    EXPECT_EQ(edit::free_paint_path(document, anna), at("An-na-B--3.nvpaint")) << "one is in the document";
    edit::add_paint_layer(document.file, anna, at("An-na-B--3.nvpaint"), {});
    EXPECT_EQ(edit::free_paint_path(document, anna), at("An-na-B--4.nvpaint")) << "one is used";
}

TEST_F(Layers, ThatAreSharedBecomeOnesOwn) {
    const size_t used = edit::paint_layers_of(document.file, anna)->size();
    edit::add_paint_layer(document.file, anna, at("one.nvpaint"), {.name = "look", .opacity = 0.25});
    edit::add_paint_layer(document.file, anna, at("two.nvpaint"), {});
    EXPECT_FALSE(edit::is_shared(document.file, anna, at("one.nvpaint")));
    edit::duplicate_node(document.file, anna, edit::CopySettings{});
    const auto copy = static_cast<uint32_t>(document.file.json["nodes"].size() - 1);
    EXPECT_TRUE(edit::is_shared(document.file, anna, at("one.nvpaint")));
    EXPECT_TRUE(edit::is_shared(document.file, copy, at("one.nvpaint")));

    const auto before = edit::paint_layers_of(document.file, anna).value();
    edit::unshare_paint(document, copy, used, at("own.nvpaint"), layer(0.5f));
    const auto after = edit::paint_layers_of(document.file, copy).value();
    ASSERT_EQ(after.size(), before.size());
    for (size_t i = 0; i < after.size(); ++i) {
        EXPECT_EQ(after[i].path, i == used ? at("own.nvpaint") : before[i].path) << i;
        EXPECT_EQ(after[i].entry.opacity, before[i].entry.opacity) << i;
    }
    EXPECT_EQ(edit::title_of(after[used]), "look");
    EXPECT_EQ(edit::paint_layers_of(document.file, anna)->at(used).path, at("one.nvpaint"));
    EXPECT_FALSE(edit::is_shared(document.file, copy, at("own.nvpaint")));
    EXPECT_EQ(document.paint.at(at("own.nvpaint"))->edits.size(), 1u);
}

// A layer on a clip in segments is a folder, with a file for each segment that has edits.
TEST_F(Layers, OfSegmentsAreSavedFileByFile) {
    const std::filesystem::path look = edit::free_paint_path(document, anna), first = look / "000000.nvpaint",
                                second = look / "000012.nvpaint";
    const auto empty = std::make_shared<const voctree::EditLayer>(voctree::EditLayer{field, {}});
    edit::set_paint(document, anna, look, "look", {{first, empty}}, "new layer");
    EXPECT_NE(edit::free_paint_path(document, anna), look);
    edit::save_document(document, document.file.path);
    EXPECT_TRUE(std::filesystem::is_directory(look)) << "the stage can be loaded again";
    EXPECT_FALSE(std::filesystem::exists(first)) << "nothing is painted";

    edit::set_paint(document, anna, look, "look", {{first, layer(1)}, {second, layer(0.5f)}}, "painted");
    EXPECT_EQ(edit::paint_layers_of(document.file, anna)->back().path, look);
    document.paint[at("unused.nvpaint")] = layer(1);
    document.paint[at("gone.nvpaint/000000.nvpaint")] = layer(1);
    edit::save_document(document, document.file.path);
    EXPECT_EQ(voctree::read_paint(first, field).edits, layer(1)->edits);
    EXPECT_EQ(voctree::read_paint(second, field).edits, layer(0.5f)->edits);
    EXPECT_FALSE(std::filesystem::exists(at("unused.nvpaint")));
    EXPECT_FALSE(std::filesystem::exists(at("gone.nvpaint")));

    edit::set_paint(document, anna, look, "look", {{second, empty}}, "restored");
    edit::save_document(document, document.file.path);
    EXPECT_FALSE(std::filesystem::exists(second));
    EXPECT_TRUE(std::filesystem::exists(first));
    EXPECT_EQ(voctree::files_of_layer(document.paint, look).size(), 2u);
    EXPECT_EQ(voctree::files_of_layer(document.paint, at("unused.nvpaint")).size(), 1u);
    EXPECT_TRUE(voctree::files_of_layer(document.paint, at("unused")).empty());
}

}  // namespace
}  // namespace neuvv
