// Tests of editing: what a user does to the stage is displayed and saved.
#include "support/segmented_copy.h"
#include "viewer_window/viewer_window.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Editing : ViewerWindow {
    void save(Hands& hands) const {
        hands.key("ctrl+s");
        hands.until("all to be saved", [](const json& now) { return now["modified"] == false; });
        hands.until_rest();
    }
    // A stroke over the chest, by a wider brush. Afterwards the pointer is away from what is compared, with the circle
    // of the brush. `until_painted` waits for the paint.
    static media::Image painted_chest(Hands& hands, const std::function<void()>& until_painted) {
        hands.click("stage/anna");
        hands.click("tab/paint");
        hands.click("paint/colour");
        const Spot chest = hands.in_image(0.5, 0.5);
        hands.point(chest);
        for (int i = 0; i < 8; ++i) hands.key("bracketright");
        hands.drag({chest.x - 4, chest.y - 30}, {chest.x + 4, chest.y + 12});
        until_painted();
        hands.until_rest();
        hands.point(hands.in_image(0.02, 0.98));
        return hands.image();
    }
    // The path of the only layer of anna.
    std::filesystem::path layer_of_anna() const {
        const json document = saved();
        const json layers = document["nodes"][node(document, "anna")]["extensions"]["NEUVV_performer"]["paint"];
        EXPECT_EQ(layers.size(), 1u) << document;
        return folder.path / layers.at(0)["uri"].get<std::string>();
    }
    json time_of_anna() const {
        const json document = saved();
        return document["nodes"][node(document, "anna")]["extensions"]["NEUVV_performer"].value("time", json::array());
    }
};

// A click that comes before the render thread has the stage of the edit before it selects all the same.
TEST_F(Editing, AClickRightAfterAMoveSelects) {
    const auto hands = open(stage);
    hands->until_rest();
    for (int i = 0; i < 3; ++i) {
        hands->click("stage/key");
        hands->key("ctrl+d");
        hands->click(hands->in_image(0.5, 0.5));
        hands->until("the performer to be selected", [&](const json& now) {
            return now["selected"].is_number() && now["selected"] == node(saved(), "anna");
        });
    }
}

TEST_F(Editing, BackwardsIsSeenSavedAndUndone) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const media::Image forwards = hands->image();
    hands->click("timeline/anna/menu");
    hands->click("timeline/anna/reverse");
    hands->key("Escape");
    hands->until("an edit", [](const json& now) { return now["modified"] == true; });
    const media::Image backwards = hands->image();
    EXPECT_TRUE(other(forwards, backwards));
    EXPECT_TRUE(time_of_anna().empty()) << "not saved yet";
    save(*hands);
    EXPECT_FALSE(time_of_anna().empty());
    EXPECT_TRUE(same(backwards, rendered(backwards)));

    hands->key("ctrl+z");
    hands->until("the edit to be undone", [](const json& now) { return now["modified"] == true; });
    EXPECT_TRUE(same(forwards, hands->image()));
    save(*hands);
    EXPECT_TRUE(time_of_anna().empty());
    hands->key("ctrl+shift+z");
    hands->until("the edit to be done again", [](const json& now) { return now["modified"] == true; });
    EXPECT_TRUE(same(backwards, hands->image()));
}

TEST_F(Editing, TheEndOfAClipIsTrimmedByItsGrip) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const Spot end = hands->centre_of("timeline/anna/end"), start = hands->centre_of("timeline/anna/start");
    hands->drag(end, {std::round((start.x + end.x) / 2), end.y});
    hands->until("an edit", [](const json& now) { return now["modified"] == true; });
    save(*hands);
    const json half = time_of_anna();
    EXPECT_FALSE(half.empty());
    hands->key("ctrl+z");
    save(*hands);
    EXPECT_TRUE(time_of_anna().empty()) << "the whole drag is one step";
    hands->key("ctrl+shift+z");
    save(*hands);
    EXPECT_EQ(time_of_anna(), half);
}

TEST_F(Editing, TheRulerScrubs) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const std::vector<double> ruler = hands->seen()["items"]["timeline/ruler"];
    hands->click(Spot{std::round(ruler[0] + 0.4 * ruler[2]), std::round(ruler[1] + ruler[3] / 2)});
    const double time_s = hands->until("another time", [](const json& now) { return now["time_s"] > 0.1; })["time_s"];
    const media::Image then = hands->image();
    EXPECT_TRUE(same(then, rendered(then, {"--time", std::to_string(time_s)}))) << time_s;
    EXPECT_EQ(hands->seen()["modified"], false);
}

TEST_F(Editing, AStrokeIsSeenSavedAndUndone) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const media::Image bare = hands->image();
    const media::Image painted =
        painted_chest(*hands, [&] { hands->until("paint", [](const json& now) { return now["modified"] == true; }); });
    EXPECT_TRUE(other(bare, painted));
    save(*hands);
    EXPECT_TRUE(same(painted, rendered(painted)));
    const voctree::EditLayer layer =
        voctree::read_paint(layer_of_anna(), voctree::painted_field(voctree::read_nvv(clip)));
    EXPECT_GT(layer.edits.size(), 10u);

    hands->key("ctrl+z");
    hands->until("the stroke to be undone", [](const json& now) { return now["modified"] == true; });
    EXPECT_TRUE(same(bare, hands->image()));
    hands->key("ctrl+shift+z");
    EXPECT_TRUE(same(painted, hands->image()));
}

TEST_F(Editing, AStrokeOnAClipInSegmentsGoesOnInTheOthers) {
    const std::string parts = file("parts.nvv");
    write_segmented_copy(waver_tree(), {3, kWaverFrames - 3}, parts);
    write_stage(stage, parts, "anna");
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const media::Image bare = hands->image();
    const media::Image painted = painted_chest(*hands, [&] { hands->until_notice("painted in 1 more segment"); });
    EXPECT_TRUE(other(bare, painted));
    save(*hands);
    EXPECT_TRUE(same(painted, rendered(painted)));
    const std::filesystem::path layer = layer_of_anna();
    for (const uint32_t first : {0u, 3u}) {
        const voctree::ClipSegment segment{std::filesystem::path(parts) / voctree::segment_file_name(first), first};
        const auto edits = voctree::read_paint(voctree::paint_file(layer, segment),
                                               voctree::painted_field(voctree::read_nvv(segment.file)))
                               .edits;
        EXPECT_GT(edits.size(), 10u) << first;
    }
}

TEST_F(Editing, AnImageIsProjectedOntoWhoIsUnderIt) {
    media::Image red(4, 4);
    for (size_t i = 0; i < red.rgba.size(); i += 4) red.rgba[i] = red.rgba[i + 3] = 255;
    media::write_png(file("red.png"), red);
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const media::Image bare = hands->image();
    hands->click("stage/anna");
    hands->click("tab/paint");
    hands->click("paint/stamp");
    hands->click("paint/File");
    hands->type(file("red.png"));
    hands->key("Return");
    hands->point(hands->in_image(0.5, 0.5));
    hands->centre_of("paint/stamp-area");
    hands->click(hands->in_image(0.5, 0.5));
    hands->until("paint", [](const json& now) { return now["modified"] == true; });
    hands->point(hands->in_image(0.02, 0.98));
    const media::Image stamped = hands->image();
    EXPECT_TRUE(other(bare, stamped));
    const uint8_t* centre = stamped.at(stamped.width / 2, stamped.height / 2);
    EXPECT_GT(centre[0], 2 * std::max(centre[1], centre[2])) << "red";
    hands->key("ctrl+z");
    EXPECT_TRUE(same(bare, hands->image()));
}

TEST_F(Editing, PaintOnACopyOfTheStageLeavesTheFirstAlone) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    hands->click("stage/anna");
    hands->click("tab/paint");
    hands->click("paint/colour");
    const auto stroke = [&](double y) {
        const Spot chest = hands->in_image(0.5, y);
        hands->drag({chest.x - 6, chest.y}, {chest.x + 6, chest.y + 8});
        hands->until("paint", [](const json& now) { return now["modified"] == true; });
        hands->until_rest();
    };
    stroke(0.45);
    save(*hands);
    const json before = saved();
    const std::string uri = before["nodes"][node(before, "anna")]["extensions"]["NEUVV_performer"]["paint"][0]["uri"];
    const std::string paint = read_text(folder.path / uri);

    hands->key("ctrl+shift+s");
    hands->centre_of("question/name");
    hands->type("copy");
    hands->key("Return");
    hands->until("the copy", [&](const json& now) { return now["open"] == file("copy.gltf"); });
    stroke(0.5);
    save(*hands);
    EXPECT_EQ(read_text(folder.path / uri), paint);
    EXPECT_EQ(saved(), before);
    const json copy = json::parse(read_text(file("copy.gltf")));
    const json layers = copy["nodes"][node(copy, "anna")]["extensions"]["NEUVV_performer"]["paint"];
    ASSERT_EQ(layers.size(), 1u);
    EXPECT_NE(layers[0]["uri"], uri);
    EXPECT_NE(read_text(folder.path / layers[0]["uri"].get<std::string>()), paint);
}

TEST_F(Editing, WhatIsSavedOpensAsItWas) {
    media::Image before;
    {
        const auto hands = open(stage, "960x540");
        hands->until_rest();
        hands->click("timeline/anna/menu");
        hands->click("timeline/anna/reverse");
        hands->key("Escape");
        hands->until("an edit", [](const json& now) { return now["modified"] == true; });
        save(*hands);
        before = hands->image();
        hands->key("ctrl+q");
        EXPECT_EQ(hands->wait_for_end(), 0);
    }
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    EXPECT_TRUE(same(before, hands->image()));
}

}  // namespace
}  // namespace neuvv::test
