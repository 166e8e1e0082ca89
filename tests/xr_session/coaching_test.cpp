// Coaching with a performer in the headset: what turns red, the ghost, and what the panel's page does.
#include "coach/guide.h"
#include "golden/golden.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/trainer_figure.h"
#include "voctree/files/nvv.h"
#include "xr/body_tracking_types.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

constexpr uint32_t kClipFrames = 100;  // at 25 a second

// Anna has a skeleton, and stands with her arms spread.
struct Coaching : XrSession {
    std::string trainee = (folder.path / "trainee.skeleton.glb").string();

    Coaching() {
        voctree::write_nvv(clip, standing_tree(kClipFrames));
        motion::write_skeleton(folder.path / "figure.skeleton.glb", still_clip(standing_pose(), kClipFrames));
        motion::write_skeleton(trainee, still_clip(pose_with_arm_raised(60), 1000));
    }

    // A script with a body that stands where the user does, and the panel.
    static XrScript with_body_and_panel(const motion::Pose& pose) {
        XrScript script;
        script.json["bodies"] = {"bd"};
        script.body(0, body_of_wearer(pose));
        script.hand(0, "right", kRightHand, kAnna);
        script.hand(0, "left", kLeftHand, {-3, 1, -4});
        script.click(kReady, "left", "y/click");
        return script;
    }
    // The pose, 1.6 m tall and facing −Z, by the numbers of XR_BD_body_tracking.
    static json body_of_wearer(const motion::Pose& pose) {
        using enum motion::Joint;
        const std::pair<int, motion::Joint> joints[] = {
            {XR_BODY_JOINT_LEFT_HIP_BD, kLeftHip},           {XR_BODY_JOINT_RIGHT_HIP_BD, kRightHip},
            {XR_BODY_JOINT_LEFT_KNEE_BD, kLeftKnee},         {XR_BODY_JOINT_RIGHT_KNEE_BD, kRightKnee},
            {XR_BODY_JOINT_LEFT_ANKLE_BD, kLeftAnkle},       {XR_BODY_JOINT_RIGHT_ANKLE_BD, kRightAnkle},
            {XR_BODY_JOINT_LEFT_FOOT_BD, kLeftBigToe},       {XR_BODY_JOINT_RIGHT_FOOT_BD, kRightBigToe},
            {XR_BODY_JOINT_LEFT_SHOULDER_BD, kLeftShoulder}, {XR_BODY_JOINT_RIGHT_SHOULDER_BD, kRightShoulder},
            {XR_BODY_JOINT_LEFT_ELBOW_BD, kLeftElbow},       {XR_BODY_JOINT_RIGHT_ELBOW_BD, kRightElbow},
            {XR_BODY_JOINT_LEFT_WRIST_BD, kLeftWrist},       {XR_BODY_JOINT_RIGHT_WRIST_BD, kRightWrist}};
        json body;
        for (const auto& [number, joint] : joints) {
            const glm::dvec3 at = motion::at(pose, joint).position;
            body["joints"][std::to_string(number)] = {{"at", {1.6 * (0.5 - at.x), 1.6 * at.y, 1.6 * (0.5 - at.z)}},
                                                      {"flags", "tracked"}};
        }
        return body;
    }
    static double red(const XrRun& run, const char* limb) { return run.seen["coach"]["red"][limb]; }
};

// The number of pixels of about this colour (sRGB, 0..1).
size_t pixels_of(const media::Image& image, const glm::vec3& colour) {
    size_t count = 0;
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        bool alike = true;
        for (int c = 0; c < 3; ++c)
            alike = alike && std::abs(image.rgba[i + static_cast<size_t>(c)] - 255 * colour[c]) < 12;
        count += alike;
    }
    return count;
}

// The number of pixels that are redder in `a` than in `b`, by 60 steps of red against green.
size_t redder_pixels(const media::Image& a, const media::Image& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.rgba.size(); i += 4)
        count += (a.rgba[i] - a.rgba[i + 1]) - (b.rgba[i] - b.rgba[i + 1]) > 60;
    return count;
}

TEST_F(Coaching, AnArmThatIsOffIsRedAndTheGhostIsSeen) {
    XrScript script;
    script.json["profile"] = "";  // no hands in the image
    script.save(130);
    script.end(132);
    const XrRun plain = run(script, {"--play"}), coached = run(script, {"--trainee", trainee});
    expect_clean(coached);
    EXPECT_TRUE(plain.seen["coach"].is_null());
    EXPECT_EQ(coached.seen["coach"]["trainer"], "anna");
    EXPECT_GT(red(coached, "left arm"), 0.9) << coached.seen.dump(1);
    for (const char* limb : {"trunk", "head", "right arm", "right leg", "left leg"}) EXPECT_EQ(red(coached, limb), 0);
    EXPECT_TRUE(coached.seen["coach"]["remarks"][0].get<std::string>().starts_with("left arm"));
    EXPECT_EQ(coached.seen["coach"]["mode"], "perform") << "a recorded trainee does not wait for the clip";
    EXPECT_EQ(coached.seen["modified"], false);
    const media::Image with = coached.image(130, "left"), without = plain.image(130, "left");
    EXPECT_GT(redder_pixels(with, without), 40u);
    for (const coach::GuideKind kind :
         {coach::GuideKind::kGhost, coach::GuideKind::kGhostWrong, coach::GuideKind::kArrow}) {
        const glm::vec3 colour = coach::kGuideColours[static_cast<size_t>(kind)];
        EXPECT_GT(pixels_of(with, colour), 10u) << static_cast<int>(kind);
        EXPECT_EQ(pixels_of(without, colour), 0u) << static_cast<int>(kind);
    }
    EXPECT_EQ(check_golden("xr_coaching", with), "");
}

TEST_F(Coaching, ThePanelBeginsItWithTheWearersBodyAndTurnsTheTrainer) {
    with_layer = false;
    const XrScript opened = with_body_and_panel(pose_with_arm_raised(60));
    XrScript script = opened;
    press(script, 12, panel_after(opened, 14), "coach");
    const json items = panel_after(script, 24);
    press(script, 24, items, "begin coaching");
    XrScript watching = script;
    watching.save(190);
    watching.end(192);
    const XrRun before = run(watching);
    expect_clean(before);
    EXPECT_GT(red(before, "left arm"), 0.9) << before.seen.dump(1) << before.log;
    EXPECT_EQ(red(before, "right arm"), 0);
    EXPECT_EQ(before.seen["coach"]["trainer_turned_deg"], 0);

    press(script, 192, items, "show me");
    script.save(250);
    XrScript ended = script;
    script.event(252, "lose_session");
    script.end(290);
    const XrRun turned = run(script);
    EXPECT_EQ(turned.code, 0) << turned.log;
    EXPECT_EQ(turned.report["violations"], json::array());
    EXPECT_GT(red(turned, "left arm"), 0.9) << "coaching outlives a lost session";
    const size_t first = turned.log.find("your body: "), second = turned.log.find("your body: ", first + 1);
    EXPECT_NE(second, std::string::npos) << "which has a tracker of its own: " << turned.log;
    const double angle_deg = turned.seen["coach"]["trainer_turned_deg"];
    EXPECT_GT(std::abs(angle_deg), 5);
    EXPECT_EQ(turned.seen["turned_deg"], before.seen["turned_deg"]) << "the user stays";
    EXPECT_FALSE(same_pixels(turned.image(250, "left"), before.image(190, "left"), 30));
    EXPECT_EQ(turned.seen["modified"], false);

    press(ended, 252, items, "begin coaching");  // where it says End now
    ended.end(266);
    const XrRun after = run(ended);
    expect_clean(after);
    EXPECT_TRUE(after.seen["coach"].is_null());
    EXPECT_EQ(after.seen["speed"], 1) << "the clock's own";
}

// On the wrist, the panel is held before the trainer.
TEST_F(Coaching, APanelThatIsNearerHidesTheGhost) {
    write_settings(R"({"hands": {"hints": false}, "panel": {"onWrist": true}})");
    XrScript script;
    script.hand(0, "left", {0, 0.95, -0.6}, {0, 0.95, -2});
    script.lose(0, "right");
    script.click(kReady, "left", "y/click");
    script.save(40);
    script.end(42);
    const XrRun plain = run(script, {"--play"}), coached = run(script, {"--trainee", trainee});
    expect_clean(coached);
    const media::Image without = plain.image(40, "left"), with = coached.image(40, "left");
    size_t hole = 0, drawn = 0, beside = 0;
    for (size_t i = 3; i < with.rgba.size(); i += 4) {
        hole += without.rgba[i] == 0;
        drawn += without.rgba[i] == 0 && with.rgba[i] != 0;
    }
    for (const coach::GuideKind kind : {coach::GuideKind::kGhost, coach::GuideKind::kGhostWrong})
        beside += pixels_of(with, coach::kGuideColours[static_cast<size_t>(kind)]);
    EXPECT_GT(hole, 500u);
    EXPECT_EQ(drawn, 0u) << "lines over the panel";
    EXPECT_GT(beside, 0u) << "they are seen beside it";
}

TEST_F(Coaching, ASourceThatCannotBeOpenedIsALine) {
    XrScript script;
    script.end(6);
    const XrRun run = this->run(script, {"--trainee", (folder.path / "nobody.jsonl").string()});
    EXPECT_NE(run.code, 0);
    EXPECT_NE(run.log.find("nobody.jsonl"), std::string::npos) << run.log;
    std::filesystem::remove(folder.path / "figure.skeleton.glb");
    const XrRun other = this->run(script, {"--trainee", trainee});
    EXPECT_NE(other.code, 0);
    EXPECT_NE(other.log.find("has no performer with a skeleton"), std::string::npos) << other.log;
}

}  // namespace
}  // namespace neuvv::test
