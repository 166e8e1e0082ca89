// Coaching in the headset without one: the trainer's turn, the clock's speed, and the panel's page.
#include "tools/headset/state/coaching.h"

#include <imgui.h>

#include "headset/hands_at_a_stage.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/trainer_figure.h"
#include "tools/headset/panel/panel.h"
#include "tools/ui/theme.h"

namespace neuvv::test {
namespace {

using headset::Coaching;
using headset::TrainerTurn;

double heading(const glm::dvec3& direction) {
    return std::atan2(direction.x, direction.z);
}
glm::dvec3 moved(const glm::dmat4& by, const glm::dvec3& point) {
    return by * glm::dvec4(point, 1);
}

TEST(TrainerTurnTest, TheSideThatFacesTheEyeFacesTheHeadAfterIt) {
    const glm::dvec3 centre(0.5, 1, -0.2), eye(2.5, 1.4, -0.2), head(0.3, 1.7, 4);
    TrainerTurn turn;
    turn.show(centre, eye, head);
    EXPECT_EQ(turn.angle_rad(), 0) << "it begins where the trainer is";
    turn.advance(TrainerTurn::kTurn_s / 2);
    const double whole = heading(head - centre) - heading(eye - centre);
    EXPECT_NEAR(turn.angle_rad(), whole / 2, 1e-9);
    turn.advance(TrainerTurn::kTurn_s);
    const glm::dmat4 turned = turn.performer_from_turned();
    EXPECT_NEAR(turn.angle_rad(), whole, 1e-9);
    EXPECT_NEAR(heading(moved(turned, eye) - centre), heading(head - centre), 1e-9);
    EXPECT_NEAR(moved(turned, eye).y, eye.y, 1e-9) << "its axis is vertical";
    EXPECT_LT(glm::distance(moved(turned, centre), centre), 1e-9);

    // Another one goes on from there; head and eye are in the space that is drawn now.
    turn.show(centre, eye, moved(glm::inverse(turned), head + glm::dvec3(3, 0, 0)));
    EXPECT_NEAR(turn.angle_rad(), whole, 1e-9);
    turn.advance(1);
    EXPECT_NEAR(heading(moved(turn.performer_from_turned(), eye) - centre),
                heading(head + glm::dvec3(3, 0, 0) - centre), 1e-9);
}

TEST(TrainerTurnTest, ItTakesTheShorterWayAndStaysWhereThereIsNoHeading) {
    TrainerTurn turn;
    turn.show(glm::dvec3(0), {0.1, 0, -1}, {-0.1, 0, -1});
    turn.advance(1);
    EXPECT_LT(std::abs(turn.angle_rad()), 0.3);
    const double before = turn.angle_rad();
    turn.show(glm::dvec3(0), {0, 2, 0}, {1, 0, 0});
    turn.show(glm::dvec3(0), {1, 0, 0}, glm::dvec3(NAN));
    turn.advance(1);
    EXPECT_EQ(turn.angle_rad(), before);
}

struct CoachingTest : HandsAtAStage {
    Coaching coaching{jobs};
    glm::dvec3 world_head{0, 1.5, 0};
    motion::Pose body = standing_pose();

    CoachingTest() {
        motion::write_skeleton(folder.path / "figure.skeleton.glb", still_clip(standing_pose(), 2));
        state.clock.speed = 1.5;
    }
    void begin() {
        coaching.begin(state);
        wait_for_begin();
    }
    void wait_for_begin() {
        for (int i = 0; i < 60'000 && !coaching.is_running(); ++i) {
            jobs.run_posted();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        ASSERT_TRUE(coaching.is_running());
    }
    void perform(double seconds) {
        constexpr double kStep_s = 0.02;
        for (double t = 0; t < seconds; t += kStep_s) {
            jobs.run_posted();
            state.clock.tick(kStep_s);
            state.evaluate();
            coaching.turn_trainer(state, kStep_s);
            coaching.update(state, body, world_head);
        }
    }
    double red(motion::Limb limb) const { return coaching.session().coach().red()[motion::index_of(limb)]; }
};

TEST_F(CoachingTest, ALimbThatIsOffIsRedAndTheClipWaits) {
    begin();
    EXPECT_EQ(coaching.session().trainer_name(), "anna");
    EXPECT_TRUE(state.clock.playing);
    perform(1);
    EXPECT_EQ(red(motion::Limb::kLeftArm), 0);
    EXPECT_NEAR(state.clock.speed, 1, 1e-9);
    body = pose_with_arm_raised(60);
    perform(6);
    EXPECT_GT(red(motion::Limb::kLeftArm), 0.9);
    EXPECT_EQ(red(motion::Limb::kRightArm), 0);
    EXPECT_LT(state.clock.speed, 0.5);
    EXPECT_FALSE(coaching.session().guide().empty());
    EXPECT_TRUE(coaching.session().highlight().highlight);
    coaching.end(state);
    EXPECT_EQ(state.clock.speed, 1.5) << "as before";
    EXPECT_TRUE(coaching.session().guide().empty());
    EXPECT_FALSE(coaching.session().highlight().highlight);
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(CoachingTest, ShowMeTurnsTheTrainerAndNothingElse) {
    select(kBen);
    begin();
    EXPECT_EQ(coaching.session().trainer_name(), "ben");
    state.evaluate();
    const glm::dmat4 anna = state.evaluated.performers[0].world_from_performer,
                     ben = state.evaluated.performers[1].world_from_performer;
    const xr::XrRig rig = state.rig;
    body = pose_with_arm_raised(60);
    perform(6);
    ASSERT_TRUE(coaching.session().best_view());
    world_head = {-4, 1.5, -2.5};  // beside the trainer
    perform(0.1);
    coaching.show_best_view();
    perform(TrainerTurn::kTurn_s + 0.1);
    const auto view = coaching.session().best_view();
    ASSERT_TRUE(view);
    EXPECT_NEAR(heading(view->eye - view->target), heading(world_head - view->target), 0.05);
    const stage::EvaluatedPerformer& turned = state.evaluated.performers[1];
    EXPECT_GT(glm::distance(turned.world_from_performer[0], ben[0]), 0.3);
    EXPECT_EQ(state.evaluated.performers[0].world_from_performer, anna);
    EXPECT_EQ(state.rig.position, rig.position);
    EXPECT_EQ(state.rig.yaw_rad, rig.yaw_rad);
    EXPECT_EQ(undo_all(), 0u);
    coaching.end(state);
    perform(0.1);
    EXPECT_EQ(state.evaluated.performers[1].world_from_performer, ben);
}

TEST_F(CoachingTest, EndAndBeginKeepTheTraineesSource) {
    const std::string trainee = (folder.path / "trainee.skeleton.glb").string();
    motion::write_skeleton(trainee, still_clip(pose_with_arm_raised(60), 1000));
    coaching.begin(state, coach::read_trainer(*state.stage, ""), motion::open_pose_source(trainee));
    perform(0.5);
    ASSERT_TRUE(coaching.session().source());
    const std::string name = coaching.session().source()->name();
    coaching.end(state);
    perform(0.1);
    EXPECT_FALSE(coaching.needs_body());
    begin();
    ASSERT_TRUE(coaching.session().source());
    EXPECT_EQ(coaching.session().source()->name(), name);
    EXPECT_FALSE(coaching.needs_body()) << "the wearer is not the trainee";
    perform(6);
    EXPECT_GT(red(motion::Limb::kLeftArm), 0.9) << "it is compared again";
}

TEST_F(CoachingTest, ThePanelOpensBesideTheTrainerWhoIsNotSelected) {
    begin();
    perform(0.1);
    ASSERT_FALSE(state.editor.selected());
    head = {{0, 1.5, 0}, xr::turn_by(std::atan2(0.8, 2.0))};  // the user looks at anna
    inputs[xr::kLeft].menu = true;
    state.follow_document();
    interaction.update(state, inputs, head, 1.0 / 90);
    ASSERT_TRUE(interaction.panel);
    const auto [low, high] = editor::box_of(state, *state.trainer);
    const auto seen =
        headset::seen_between(head, {state.evaluated.performers[*state.trainer].world_from_performer, low, high});
    ASSERT_TRUE(seen);
    const auto left_of = [&](glm::dvec3 at) {
        const glm::dvec3 in_view = xr::inverse(head) * at;
        return std::atan2(-in_view.x, -in_view.z);
    };
    const double left = left_of(interaction.panel->point_at({0, 0.5})),
                 right = left_of(interaction.panel->point_at({1, 0.5}));
    const double covered = std::min(left, seen->second) - std::max(right, seen->first);
    EXPECT_LT(covered, 0) << glm::degrees(left) << " " << glm::degrees(right);
    EXPECT_LT(std::abs(left), glm::radians(50.0)) << "the panel is in view";
    EXPECT_LT(std::abs(right), glm::radians(50.0));
    coaching.end(state);
    EXPECT_FALSE(state.trainer);
}

TEST_F(CoachingTest, WithoutASkeletonANoticeSaysHowToMakeOne) {
    std::filesystem::remove(folder.path / "figure.skeleton.glb");
    coaching.begin(state);
    settle();
    EXPECT_FALSE(coaching.is_running());
    EXPECT_TRUE(was_notified("make one of its clip"));
}

struct CoachingPage : CoachingTest {
    ImGuiContext* context = ImGui::CreateContext();
    headset::PanelResult seen;

    CoachingPage() {
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {960, 720};
        ui::apply_theme(1.75f);
        io.Fonts->Build();
        state.tool = headset::HandTool::kCoach;
        draw(false);
    }
    ~CoachingPage() override { ImGui::DestroyContext(context); }

    void draw(bool down) {
        ImGui::GetIO().DeltaTime = 1 / 90.0f;
        ImGui::GetIO().MouseDown[0] = down;
        ImGui::NewFrame();
        seen = headset::draw_panel(state, interaction, coaching, {});
        ImGui::Render();
    }
    void press(const std::string& item) {
        ASSERT_TRUE(seen.items.contains(item)) << item;
        ImGui::GetIO().MousePos = {static_cast<float>(seen.items[item].x) * 960,
                                   static_cast<float>(seen.items[item].y) * 720};
        for (const bool down : {false, true, false, false}) draw(down);
    }
};

TEST_F(CoachingPage, EachControlDoesWhatItSays) {
    const coach::CoachSettings& settings = coaching.settings;
    press("perform");
    EXPECT_EQ(settings.mode, coach::Mode::kPerform);
    press("watch");
    EXPECT_EQ(settings.mode, coach::Mode::kWatch);
    press("follow");
    EXPECT_EQ(settings.mode, coach::Mode::kFollow);
    press("speed 0.25");
    EXPECT_EQ(settings.speed, 0.25);
    press("speed 1");
    EXPECT_EQ(settings.speed, 1);
    press("mirror image");
    EXPECT_TRUE(settings.mirrored);
    press("mirror image");
    EXPECT_FALSE(settings.mirrored);
    press("ghost");
    EXPECT_FALSE(settings.ghost);
    press("arrows");
    EXPECT_FALSE(settings.arrows);
    for (size_t i = 0; i < motion::kLimbs; ++i) {
        press(motion::kLimbNames[i]);
        for (size_t j = 0; j < motion::kLimbs; ++j) EXPECT_EQ(settings.compare.counted[j], j > i) << i << " " << j;
    }
}

TEST_F(CoachingPage, ItBeginsRepeatsShowsAndEnds) {
    press("begin coaching");
    wait_for_begin();
    draw(false);
    body = pose_with_arm_raised(60);
    perform(6);
    draw(false);
    press("show me");
    perform(1);
    EXPECT_NE(coaching.turn().angle_rad(), 0);
    state.clock.pause();
    press("again");
    EXPECT_TRUE(state.clock.playing);
    const double lowest = seen.items["left arm"].y;
    EXPECT_LT(lowest, seen.items["undo"].y - 0.1) << "remarks have room";
    press("end coaching");
    EXPECT_FALSE(coaching.is_running());
    EXPECT_EQ(undo_all(), 0u);
}

}  // namespace
}  // namespace neuvv::test
