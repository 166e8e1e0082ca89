// Coaching in the window, by clicks: begin, what turns red, again, show me, the report, end.
#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/trainee.h"
#include "viewer_window/viewer_window.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Coaching : ViewerWindow {
    std::string trainee = file("trainee.skeleton.glb");

    void SetUp() override {
        ViewerWindow::SetUp();
        if (IsSkipped()) return;
        const motion::SkeletonClip dancer = performer_motion(75);
        motion::write_skeleton(file("waver.skeleton.glb"), dancer);
        motion::SkeletonClip learner =
            other_body(with_arm_off(dancer, motion::Limb::kLeftArm, 35, 0, 3), 0.9, {1, 0, 2}, 0.6);
        const std::vector<motion::Pose> once = learner.frames;
        for (int i = 0; i < 40; ++i) learner.frames.insert(learner.frames.end(), once.begin(), once.end());
        motion::write_skeleton(trainee, learner);
    }
    static double red(const json& now, const char* limb) {
        return now["coach"].is_null() ? 0 : now["coach"]["red"][limb].get<double>();
    }
};

TEST_F(Coaching, ClicksBeginItAndEveryControlDoesWhatItSays) {
    const auto hands = open(stage, "900x900");
    hands->until_rest();
    hands->click("tab/coach");
    hands->double_click(hands->centre_of("coach/motion from"));
    hands->key("ctrl+a");
    hands->type(trainee);
    hands->key("Return");
    hands->click("coach/begin");
    json now = hands->until("a red arm", [](const json& seen) { return red(seen, "left arm") > 0.5; });
    EXPECT_EQ(now["coach"]["trainer"], "anna");
    EXPECT_EQ(red(now, "right arm"), 0);
    EXPECT_EQ(red(now, "left leg"), 0);
    EXPECT_GT(now["coach"]["poses"], 0);
    hands->click("coach/report");
    hands->until_notice("show-report.html");
    EXPECT_NE(read_text(file("show-report.html")).find("left arm"), std::string::npos);
    const std::string remark = now["coach"]["remarks"][0];
    EXPECT_TRUE(remark.starts_with("left arm")) << remark;

    const uint64_t view = now["view"];
    hands->click("coach/show");
    hands->until("another view", [&](const json& seen) { return seen["view"] > view; });
    hands->click("coach/left arm");  // does not count any more
    hands->until("nothing to be red", [](const json& seen) { return red(seen, "left arm") == 0; });
    hands->click("coach/end");
    now = hands->until("the end", [](const json& seen) { return seen["coach"].is_null(); });
    EXPECT_EQ(now["modified"], false) << "nothing of it is an edit";
}

TEST_F(Coaching, WhatIsRedIsRedOnTheScreenAndGoneAfterwards) {
    const auto hands = std::make_unique<Hands>(
        *screen, folder.path, std::vector<std::string>{stage, "--size", "900x700", "--trainee", trainee});
    hands->until("a red arm", [](const json& seen) { return red(seen, "left arm") > 0.95; });
    hands->click("tab/coach");
    hands->key("space");
    hands->until("a pause", [](const json& seen) { return seen["playing"] == false; });
    const media::Image during = hands->image();
    hands->click("coach/end");
    hands->until_rest();
    const media::Image after = hands->image();
    ASSERT_EQ(during.rgba.size(), after.rgba.size());
    size_t redder = 0, other = 0;
    for (size_t i = 0; i < during.rgba.size(); i += 4) {
        const auto green_of = [i](const media::Image& image) { return int{image.rgba[i + 1]} - image.rgba[i]; };
        redder += green_of(after) - green_of(during) > 60;
        other += green_of(during) - green_of(after) > 20;
    }
    EXPECT_GT(redder, 100u) << "an arm";
    EXPECT_EQ(other, 0u);
}

// As files that are dropped on the window.
TEST_F(Coaching, ASkeletonIsTheSelectedPerformersOrIsCompared) {
    const auto hands = open(stage, "900x700");
    hands->until_rest();
    const auto give = [&] {
        hands->key("ctrl+o");
        hands->centre_of("question/name");
        hands->type("trainee.skeleton.glb");
        hands->key("Return");
    };
    give();
    const json compared = hands->until("coaching", [](const json& seen) { return !seen["coach"].is_null(); });
    EXPECT_EQ(compared["coach"]["trainer"], "anna");
    EXPECT_EQ(compared["modified"], false);
    hands->click("tab/coach");
    hands->click("coach/end");
    hands->until("the end", [](const json& seen) { return seen["coach"].is_null(); });
    hands->click("stage/anna");
    give();
    hands->until("an edit", [](const json& seen) { return seen["modified"] == true; });
    hands->key("ctrl+s");
    hands->until("all to be saved", [](const json& seen) { return seen["modified"] == false; });
    const json document = saved();
    const json& anna = document["nodes"][node(document, "anna")]["extensions"]["NEUVV_performer"];
    EXPECT_EQ(anna["skeleton"]["uri"], "trainee.skeleton.glb");
}

TEST_F(Coaching, AFileThatIsNoMotionIsSaidInANotice) {
    const auto hands = std::make_unique<Hands>(
        *screen, folder.path, std::vector<std::string>{stage, "--size", "900x700", "--trainee", file("none.bvh")});
    const json now = hands->until_notice("none.bvh");
    EXPECT_TRUE(now["coach"].is_null());
}

}  // namespace
}  // namespace neuvv::test
