// Tests of a device that is lost while somebody edits.
#include "edit/recovery.h"
#include "support/losable_device.h"
#include "viewer_window/viewer_window.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Losing : ViewerWindow {
    LosableDevice device{folder.path};

    // Plays anna backwards, and goes to another time.
    std::unique_ptr<Hands> open_and_edit() const {
        auto hands = open(stage, "960x540");
        hands->until_rest();
        hands->click("timeline/anna/menu");
        hands->click("timeline/anna/reverse");
        hands->key("Escape");
        hands->until("an edit", [](const json& now) { return now["modified"] == true; });
        hands->key("period");
        hands->drag(hands->in_image(0.2, 0.3), hands->in_image(0.4, 0.35));
        hands->until_rest();
        return hands;
    }
};

TEST_F(Losing, ADeviceIsMadeAnewAndNothingElseChanges) {
    const auto hands = open_and_edit();
    const json before = hands->until_rest();
    const media::Image shown = hands->image();
    EXPECT_GT(before["time_s"], 0.0);
    device.lose();
    hands->point(hands->in_image(0.02, 0.98));
    hands->until_notice("the device was lost, and has been made anew");
    const json after = hands->until_rest();
    EXPECT_EQ(after["time_s"], before["time_s"]);
    EXPECT_EQ(after["modified"], true);
    EXPECT_TRUE(same(hands->image(), shown)) << "the same view of the same stage";
    EXPECT_TRUE(other(rendered(shown), shown)) << "which is not that of its camera";

    hands->key("ctrl+z");
    hands->until_notice("undone");
    hands->until("the file's state", [](const json& now) { return now["modified"] == false; });
    hands->until_rest();
    EXPECT_TRUE(other(hands->image(), shown)) << "the history goes on, and what it changes is seen";
    device.lose();
    hands->key("ctrl+shift+z");
    hands->until("the edit again", [](const json& now) { return now["modified"] == true; });
    hands->until_rest();
    EXPECT_TRUE(same(hands->image(), shown)) << "after a second loss, too";
}

TEST_F(Losing, OneThatIsLostAgainAndAgainEndsTheProgramAndEditsAreKept) {
    const auto hands = open_and_edit();
    device.lose(99);  // with the next frame, which comes by itself
    EXPECT_EQ(hands->wait_for_end(), 1);
    const std::string log = read_text(folder.path / "viewer.log");
    EXPECT_NE(log.find("the device was lost 4 times within 60 s"), std::string::npos) << log;
    EXPECT_NE(log.find("device lost"), std::string::npos) << log;
    EXPECT_NE(log.find("another device"), std::string::npos) << log;
    EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1) << log;
    const auto entries = edit::find_recovery(folder.path / "state/neuvv/recovery", stage);
    ASSERT_EQ(entries.size(), 1u);
    const json document = edit::restore(entries[0]).file.json.whole();
    EXPECT_FALSE(document["nodes"][node(document, "anna")]["extensions"]["NEUVV_performer"]["time"].empty())
        << "backwards";
}

}  // namespace
}  // namespace neuvv::test
