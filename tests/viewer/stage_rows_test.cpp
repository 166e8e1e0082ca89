#include "tools/viewer/panels/stage_rows.h"

#include <gtest/gtest.h>

#include "edit/operations.h"
#include "tests/stage/stage_files.h"
#include "tools/viewer/view_state.h"

namespace neuvv {
namespace {

struct StageRows : testing::Test {
    TemporaryFolder folder;
    stage::StageFile file = stage::read_stage_file(test::put_foreign_stage(folder.path));
    uint32_t node(const char* name) const { return edit::find_node(file, name); }
    viewer::StageRow row(const char* name) const {
        const std::vector<viewer::StageRow> rows = viewer::stage_rows(file);
        return rows.at(viewer::row_of(rows, node(name)).value());
    }
};

std::vector<std::string> titles(const std::vector<viewer::StageRow>& rows) {
    std::vector<std::string> all;
    for (const viewer::StageRow& row : rows) all.push_back(std::string(row.depth, '>') + row.title);
    return all;
}

TEST_F(StageRows, ParentsComeBeforeWhatHangsOnThem) {
    const std::vector<viewer::StageRow> rows = viewer::stage_rows(file);
    EXPECT_EQ(titles(rows), (std::vector<std::string>{"Floor", "Camera", "Spot", "Pivot", ">Anna", ">Sun"}));
    std::vector<edit::NodeKind> kinds;
    std::vector<uint32_t> below;
    for (const viewer::StageRow& row : rows) {
        kinds.push_back(row.kind);
        below.push_back(row.descendants);
    }
    EXPECT_EQ(kinds, (std::vector<edit::NodeKind>{edit::NodeKind::kMesh, edit::NodeKind::kCamera,
                                                  edit::NodeKind::kLight, edit::NodeKind::kGroup,
                                                  edit::NodeKind::kPerformer, edit::NodeKind::kLight}));
    EXPECT_EQ(below, (std::vector<uint32_t>{0, 0, 0, 2, 0, 0}));
}

TEST_F(StageRows, CountsWhatHangsOnWhatHangs) {
    // Sun is a child of Anna, and Anna of Pivot; another root follows.
    file.json.edit("nodes")[3]["children"] = {4};
    file.json.edit("nodes")[4]["children"] = {5};
    file.json.edit("scenes")[0]["nodes"] = {3, 0};
    file.json.edit("nodes")[0].erase("name");
    const std::vector<viewer::StageRow> rows = viewer::stage_rows(file);
    EXPECT_EQ(titles(rows), (std::vector<std::string>{"Pivot", ">Anna", ">>Sun", "node 0"}));
    EXPECT_EQ(rows[0].descendants, 2u);
    EXPECT_EQ(rows[1].descendants, 1u);
    EXPECT_EQ(viewer::row_of(rows, 1), std::nullopt) << "not in the scene";
    EXPECT_EQ(viewer::row_of(rows, 0), 3u);
}

TEST_F(StageRows, WithoutASceneAllRootsAreIt) {
    file.json.erase("scenes");
    file.json.erase("scene");
    EXPECT_EQ(titles(viewer::stage_rows(file)),
              (std::vector<std::string>{"Floor", "Camera", "Spot", "Pivot", ">Anna", ">Sun"}));
    file.json.erase("nodes");
    EXPECT_TRUE(viewer::stage_rows(file).empty());
}

TEST_F(StageRows, HiddenAndLockedAreTheNodesOwnOrFromAbove) {
    EXPECT_TRUE(row("Anna").visible && row("Anna").ancestors_visible && !row("Anna").locked);
    edit::show_node(file, node("Pivot"), false);
    edit::lock_node(file, node("Anna"), true);
    EXPECT_FALSE(row("Pivot").visible);
    EXPECT_TRUE(row("Pivot").ancestors_visible);
    EXPECT_TRUE(row("Anna").visible);
    EXPECT_FALSE(row("Anna").ancestors_visible);
    EXPECT_TRUE(row("Anna").locked);
    EXPECT_FALSE(row("Pivot").locked);
    EXPECT_TRUE(row("Floor").ancestors_visible);
}

TEST_F(StageRows, SayWhoHasASoundAndTheViewWhoIsHeard) {
    EXPECT_FALSE(row("Anna").has_sound);
    edit::PerformerEdit edit;
    edit.sound = "song.wav";
    edit::set_performer(file, node("Anna"), edit);
    EXPECT_TRUE(row("Anna").has_sound);
    EXPECT_FALSE(row("Floor").has_sound);
    viewer::ViewState view;
    EXPECT_TRUE(view.hears("Anna"));
    view.toggle_sound("Anna", false);
    EXPECT_TRUE(!view.hears("Anna") && view.hears("Berta"));
    view.toggle_sound("Anna", true);
    EXPECT_TRUE(view.hears("Anna") && !view.hears("Berta")) << "alone, although it was muted";
    view.toggle_sound("Anna", true);
    view.toggle_sound("Anna", false);
    EXPECT_TRUE(view.hears("Anna") && view.hears("Berta"));
    view.sound = false;
    EXPECT_FALSE(view.hears("Anna"));
}

TEST_F(StageRows, ClosedOnesHideWhatHangsOnThem) {
    const std::vector<viewer::StageRow> rows = viewer::stage_rows(file);
    EXPECT_EQ(viewer::listed_rows(rows, {}), (std::vector<uint32_t>{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(viewer::listed_rows(rows, {"Pivot"}), (std::vector<uint32_t>{0, 1, 2, 3}));
    std::set<std::string> closed = {"Pivot", "Floor"};
    viewer::open_ancestors(rows, 3, closed);
    EXPECT_EQ(closed.size(), 2u) << "itself and those before it stay closed";
    viewer::open_ancestors(rows, 5, closed);
    EXPECT_EQ(closed, (std::set<std::string>{"Floor"}));
}

TEST_F(StageRows, ALockKeepsAllAboveFromBeingRemoved) {
    edit::lock_node(file, node("Sun"), true);
    const std::vector<viewer::StageRow> rows = viewer::stage_rows(file);
    EXPECT_EQ(viewer::locked_within(rows, viewer::row_of(rows, node("Sun")).value()), "Sun");
    EXPECT_EQ(viewer::locked_within(rows, viewer::row_of(rows, node("Pivot")).value()), "Sun");
    EXPECT_EQ(viewer::locked_within(rows, viewer::row_of(rows, node("Anna")).value()), std::nullopt);
    EXPECT_EQ(viewer::locked_within(rows, viewer::row_of(rows, node("Floor")).value()), std::nullopt);
}

}  // namespace
}  // namespace neuvv
