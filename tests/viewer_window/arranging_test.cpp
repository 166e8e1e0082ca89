// Tests of arranging a stage: performers are clicked, moved, copied and lit, and no edit is lost.
#include "edit/recovery.h"
#include "viewer_window/viewer_window.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

const Hands::Condition kModified = [](const json& now) { return now["modified"] == true; };
const Hands::Condition kNotModified = [](const json& now) { return now["modified"] == false; };

struct Arranging : ViewerWindow {
    // Waits for edits to be stored for recovery (editor/autosave.h says how soon they are).
    void until_stored(const Hands& hands) const {
        hands.until("the recovery entry",
                    [&](const json&) { return !edit::list_recovery(folder.path / "state/neuvv/recovery").empty(); });
    }
    // A point of the image that shows anna: of all pixels that she changes on the empty stage, the one nearest to their
    // centre.
    Spot of_anna(const Hands& hands, const media::Image& image) const {
        const std::string empty = file("empty.gltf");
        stage::StageFile empty_stage = edit::new_stage(empty);
        stage::save_stage_file(empty_stage, empty);
        done({"render", empty, "-o", file("empty.png"), "--size",
              std::to_string(image.width) + "x" + std::to_string(image.height)});
        const media::Image without = media::read_png(file("empty.png"));
        std::vector<glm::dvec2> hers;
        glm::dvec2 sum(0);
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x)
                if (std::abs(image.at(x, y)[0] - without.at(x, y)[0]) > 60) {
                    hers.emplace_back(x + 0.5, y + 0.5);
                    sum += hers.back();
                }
        if (hers.empty()) throw std::runtime_error("anna is not seen");
        const glm::dvec2 centre = sum / static_cast<double>(hers.size());
        const glm::dvec2 best = *std::min_element(hers.begin(), hers.end(), [&](glm::dvec2 a, glm::dvec2 b) {
            return glm::distance(a, centre) < glm::distance(b, centre);
        });
        return hands.in_image(best.x / image.width, best.y / image.height);
    }
    void save(Hands& hands) const {
        hands.key("ctrl+s");
        hands.until("all to be saved", kNotModified);
    }
    json position_of_anna() const {
        const json document = saved();
        const json& anna = document["nodes"][node(document, "anna")];
        EXPECT_FALSE(anna.contains("matrix")) << "who was placed in parts stays so";
        return anna.value("translation", json{0.0, 0.0, 0.0});
    }
    static Hands::Condition selects(const json& what) {
        return [what](const json& now) { return now["selected"] == what; };
    }
};

TEST_F(Arranging, AClickSelectsWhoIsThere) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const Spot anna = of_anna(*hands, hands->image());
    hands->click(anna);
    hands->until("anna to be selected", selects(node(saved(), "anna")));
    hands->click(hands->in_image(0.9, 0.05));
    hands->until("nobody to be selected", selects(nullptr));
}

TEST_F(Arranging, TheGizmoMovesTheNodeAndOneUndoTakesItBack) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const media::Image before = hands->image();
    hands->click("stage/anna");
    const Spot arrow = hands->centre_of("gizmo/x");
    hands->drag(arrow, {arrow.x + 60, arrow.y});
    hands->until("an edit", kModified);
    const media::Image after = hands->image();
    EXPECT_TRUE(other(before, after));
    save(*hands);
    const json there = position_of_anna();
    EXPECT_GT(there[0].get<double>(), 0.05);
    EXPECT_EQ(there[1].get<double>(), 0);
    EXPECT_EQ(there[2].get<double>(), 0);
    hands->key("ctrl+z");
    hands->until("the move to be undone", kModified);
    EXPECT_TRUE(same(before, hands->image()));
}

TEST_F(Arranging, ACopyIsSeenSavedAndDeleted) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const media::Image before = hands->image();
    const size_t nodes = saved()["nodes"].size();
    hands->click("stage/anna");
    hands->key("ctrl+d");
    hands->until("an edit", kModified);
    hands->centre_of("stage/anna 2");
    EXPECT_TRUE(other(before, hands->image()));
    save(*hands);
    EXPECT_EQ(saved()["nodes"].size(), nodes + 1);
    hands->click("stage/anna 2");
    hands->key("Delete");
    hands->until("an edit", kModified);
    save(*hands);
    EXPECT_EQ(saved()["nodes"].size(), nodes);
    EXPECT_TRUE(same(before, hands->image()));
}

TEST_F(Arranging, MoreLightIsSeenAndSaved) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const media::Image before = hands->image();
    const json dim = saved()["extensions"]["KHR_lights_punctual"]["lights"][0];
    hands->click("stage/key");
    hands->click("tab/light");
    hands->double_click(hands->centre_of("light/intensity"));
    hands->key("ctrl+a");
    hands->type("400");
    hands->key("Return");
    hands->until("an edit", kModified);
    EXPECT_TRUE(other(before, hands->image()));
    save(*hands);
    EXPECT_EQ(saved()["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"].get<double>(), 400);
    EXPECT_NE(dim["intensity"].get<double>(), 400);
}

TEST_F(Arranging, UnsavedEditsAreAskedAboutAndDiscarded) {
    const json before = saved();
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    hands->click("stage/anna");
    hands->key("ctrl+d");
    hands->until("an edit", kModified);
    hands->key("ctrl+q");
    hands->click("question/Cancel");
    hands->until("the edit to be still there", kModified);
    hands->key("ctrl+q");
    hands->click("question/Discard");
    EXPECT_EQ(hands->wait_for_end(), 0);
    EXPECT_EQ(saved(), before);
    const auto again = open(stage, "960x540");
    again->until_rest();
    EXPECT_EQ(again->seen()["modified"], false) << "nothing is left to be recovered";
}

TEST_F(Arranging, UnsavedEditsAreSavedOnTheWayOut) {
    const auto hands = open(stage, "960x540");
    hands->until_rest();
    const size_t nodes = saved()["nodes"].size();
    hands->click("stage/anna");
    hands->key("ctrl+d");
    hands->until("an edit", kModified);
    hands->key("ctrl+q");
    hands->click("question/Save");
    EXPECT_EQ(hands->wait_for_end(), 0);
    EXPECT_EQ(saved()["nodes"].size(), nodes + 1);
    const auto again = open(stage, "960x540");
    again->until_rest();
    EXPECT_EQ(again->seen()["modified"], false) << "nothing is left to be recovered";
}

TEST_F(Arranging, AKilledViewerLosesNothingThatWasStored) {
    const size_t nodes = saved()["nodes"].size();
    {
        const auto hands = open(stage, "960x540");
        hands->until_rest();
        hands->click("stage/anna");
        hands->key("ctrl+d");
        hands->until("an edit", kModified);
        until_stored(*hands);
        hands->kill();
    }
    EXPECT_EQ(saved()["nodes"].size(), nodes);
    const auto hands = open(stage, "960x540");
    hands->click("question/Recover");
    hands->until("the edit to be back", kModified);
    save(*hands);
    EXPECT_EQ(saved()["nodes"].size(), nodes + 1);
}

// As a file that is dropped on the window.
TEST_F(Arranging, ACameraPathBecomesTheStages) {
    write_text(file("path.json"), R"({"camera_angle_y": 0.7, "w": 64, "h": 48, "frames": [
        {"transform_matrix": [[1,0,0,0],[0,1,0,1],[0,0,1,4],[0,0,0,1]], "seconds": 0},
        {"transform_matrix": [[1,0,0,1],[0,1,0,1],[0,0,1,4],[0,0,0,1]], "seconds": 2}]})");
    const auto hands = open(stage);
    hands->until_rest();
    hands->key("ctrl+o");
    hands->centre_of("question/name");
    hands->type("path.json");
    hands->key("Return");
    hands->until("an edit", kModified);
    save(*hands);
    const json path = saved()["scenes"][0]["extensions"]["NEUVV_stage"]["cameraPath"];
    EXPECT_EQ(path["keys"].size(), 2u) << path;
    write_text(file("bad.json"), "{}");
    hands->key("ctrl+o");
    hands->centre_of("question/name");
    hands->type("bad.json");
    hands->key("Return");
    hands->until_notice("bad.json");
    EXPECT_EQ(hands->seen()["modified"], false);
}

TEST_F(Arranging, AStageThatWasNeverSavedIsOfferedWithoutItsName) {
    {
        const auto hands = open(clip, "960x540");
        hands->until_rest();
        hands->click("stage/waver");
        hands->key("ctrl+d");
        hands->until("an edit", kModified);
        until_stored(*hands);
        hands->kill();
    }
    Hands hands(*screen, folder.path, {"--size", "960x540"});
    hands.click("question/Recover");
    hands.until("the edit to be back", kModified);
    EXPECT_EQ(hands.seen()["open"], file("waver.gltf"));
    hands.centre_of("stage/waver 2");
}

}  // namespace
}  // namespace neuvv::test
