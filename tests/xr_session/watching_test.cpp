// Watching: what both eyes see, and where the user stands.
#include <fmt/format.h>

#include "edit/operations.h"
#include "golden/golden.h"
#include "render/clips/stage_renderer.h"
#include "support/gpu_test.h"
#include "xr/eye_camera.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Watching : XrSession {};

TEST_F(Watching, BothEyesSeeTheStage) {
    XrScript script;
    script.save(4);
    script.end(6);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(check_golden("xr_left", run.image(4, "left")), "");
    EXPECT_EQ(check_golden("xr_right", run.image(4, "right")), "");
}

// An eye as in the script: the eyes are 64 mm apart, with the head's position between them.
xr::EyeView eye_of(const XrScript& script, int eye) {
    const auto& fov = script.json["fov_deg"][static_cast<size_t>(eye)];
    xr::EyeView view;
    view.pose.position = {eye == 0 ? -0.032 : 0.032, 1.5, 0};
    view.pose.rotation = glm::angleAxis(std::asin(-0.3 / std::hypot(0.3, 2.0)), glm::dvec3(1, 0, 0));
    const auto angle = [&](size_t i) { return static_cast<float>(glm::radians(fov[i].get<double>())); };
    view.fov = {angle(0), angle(1), angle(2), angle(3)};
    return view;
}

TEST_F(Watching, EachEyeIsTheRenderersPictureToOneStep) {
    XrScript script;
    script.json["profile"] = "";  // no hands in the image
    script.save(4);
    script.end(6);
    const XrRun run = this->run(script, {"--no-mask"});
    expect_clean(run);

    const gpu::Device device;
    const stage::Stage on_stage = stage::load_stage(stage);
    render::StageRenderer renderer(device, on_stage, render::StageLoader(device).load(on_stage), {192, 192});
    const stage::EvaluatedStage evaluated = stage::stage_at(on_stage, 0);
    renderer.show(evaluated);
    render::FrameSettings settings = renderer.settings_at(evaluated);
    settings.width = settings.height = 192;
    settings.mode = render::TraceMode::kPlay;
    for (const int eye : {0, 1}) {
        const media::Image truth =
            renderer.frames().render(xr::eye_camera(eye_of(script, eye), {}, {192, 192}), settings);
        const media::Image seen = run.image(4, eye == 0 ? "left" : "right");
        EXPECT_TRUE(same_pixels(truth, seen)) << eye;
        const media::Image other =
            renderer.frames().render(xr::eye_camera(eye_of(script, 1 - eye), {}, {192, 192}), settings);
        EXPECT_FALSE(same_pixels(other, seen)) << "the comparison tells eyes apart";
    }
}

TEST_F(Watching, CoarseDepthWillDo) {
    XrScript script;
    script.json["formats"] = {"R8G8B8A8_SRGB", "D16_UNORM"};
    script.save(4);
    script.end(6);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(run.report["layers"][0]["depth"], true);
}

TEST_F(Watching, WithoutExtensionsItGoesOn) {
    XrScript script;
    script.json["extensions"] = {"XR_KHR_vulkan_enable"};
    script.json["spaces"] = {"view", "local"};
    script.save(4);
    script.end(6);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(run.report["layers"][0]["depth"], false);
}

TEST_F(Watching, AStickTeleportsAndTurns) {
    XrScript script;
    script.hand(0, "left", kLeftHand, {-0.2, 0, -1.5});
    script.hand(0, "right", kRightHand, {3, 1, 0});
    script.stick(kReady, "left", {0, 1});
    script.save(8);
    script.stick(10, "left", {0, 0});
    script.stick(14, "right", {1, 0});
    script.stick(16, "right", {0, 0});
    script.end(20);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_NEAR(run.seen["turned_deg"].get<double>(), -30, 1e-6);
    EXPECT_LT(run.seen["stands"][2].get<double>(), -0.5) << "before where it stood";
    EXPECT_EQ(check_golden("xr_teleport", run.image(8, "left")), "");
}

TEST_F(Watching, BareHandsAreSeen) {
    XrScript script;
    script.json["profile"] = "";
    script.json["hand_joints"] = true;
    script.hand(0, "right", {0.15, 1.35, -0.5}, {0.15, 1.5, -2});
    script.hand(0, "left", {-0.15, 1.35, -0.5}, {-0.15, 1.5, -2});
    script.save(6);
    script.end(8);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(check_golden("xr_fingers", run.image(6, "left")), "");
}

TEST_F(Watching, WalkingSmoothlyDarkensTheEdges) {
    XrScript to_panel;
    to_panel.hand(0, "left", kLeftHand, {-3, 1, -4});
    to_panel.hand(0, "right", kRightHand, kAnna);
    to_panel.click(kReady, "left", "y/click");
    press(to_panel, 10, panel_after(to_panel, 14), "user page");
    const json items = panel_after(to_panel, 20);
    XrScript script = to_panel;
    press(script, 18, items, "smooth walk");
    script.click(28, "left", "y/click");
    script.stick(32, "left", {1, 0});
    script.save(48);
    script.end(52);
    const XrRun run = this->run(script, {"--no-mask"});
    expect_clean(run);
    EXPECT_NEAR(run.seen["stands"][0].get<double>(), 1.6 * 20 / 90, 0.05) << "to the right at 1.6 m/s";
    EXPECT_EQ(check_golden("xr_vignette", run.image(48, "left")), "");
}

TEST_F(Watching, ItPlaysByTheDisplaysTime) {
    constexpr double kPeriod_s = 1.0 / 90, kClip_s = 0.08;  // a clip of two frames at 25 Hz, which loops
    const auto shown_at_the_end = [&](int end_frame, int slow_frames) {
        XrScript script;
        script.click(kReady, "right", "a/click");
        if (slow_frames > 0) script.event(20, "slow", {{"frames", slow_frames}, {"periods", 3}});
        script.end(end_frame);
        const XrRun run = this->run(script);
        expect_clean(run);
        EXPECT_EQ(run.seen["playing"], true);
        return run.seen["time_s"].get<double>();
    };
    const auto difference = [&](double a, double b) { return std::abs(std::remainder(a - b, kClip_s)); };
    const double first = shown_at_the_end(30, 0);
    EXPECT_GT(first, 0);
    EXPECT_LT(difference(shown_at_the_end(40, 0), first + 10 * kPeriod_s), 1e-6) << "ten displays later";
    EXPECT_LT(difference(shown_at_the_end(30, 4), first + 4 * 2 * kPeriod_s), 1e-6)
        << "four frames took three displays each";
}

TEST_F(Watching, TheStagePausesWhileNobodyWearsTheHeadset) {
    with_layer = false;  // that of Debian 12 does not know user presence
    const auto playing_at = [&](int frame, const char* extension) {
        XrScript script;
        script.json["extensions"] = {"XR_KHR_vulkan_enable2", extension};
        script.click(kReady, "right", "a/click");
        script.event(12, "presence", {{"worn", false}});
        script.event(20, "presence", {{"worn", true}});
        script.end(frame);
        const XrRun run = this->run(script);
        expect_clean(run);
        return run.seen["playing"].get<bool>();
    };
    EXPECT_FALSE(playing_at(16, "XR_EXT_user_presence"));
    EXPECT_TRUE(playing_at(24, "XR_EXT_user_presence")) << "it goes on";
    EXPECT_TRUE(playing_at(16, "XR_KHR_visibility_mask")) << "where the runtime does not say it";
}

TEST_F(Watching, TheStagePausesWhileAMenuOfTheSystemIsInFront) {
    const auto playing_at = [&](int frame) {
        XrScript script;
        script.click(kReady, "right", "a/click");
        script.event(12, "visible");
        script.event(20, "focus");
        script.end(frame);
        const XrRun run = this->run(script, {}, false);
        expect_sound(run);
        return run.seen["playing"].get<bool>();
    };
    EXPECT_FALSE(playing_at(16));
    EXPECT_TRUE(playing_at(26)) << "it goes on";
}

TEST_F(Watching, ControllersOfExtensionsAreTakenWhereTheseAreOffered) {
    const std::pair<const char*, const char*> controllers[] = {
        {"/interaction_profiles/facebook/touch_controller_pro", "Meta Quest Pro"},
        {"/interaction_profiles/meta/touch_controller_plus", "Meta Touch Plus"},
        {"/interaction_profiles/bytedance/pico4_controller", "PICO 4"},
        {"/interaction_profiles/htc/vive_focus3_controller", "HTC Vive Focus 3"},
        {"/interaction_profiles/hp/mixed_reality_controller", "HP Reverb G2"},
        {"/interaction_profiles/ml/ml2_controller", "Magic Leap 2"},
        {"/interaction_profiles/khr/generic_controller", "Generic controller"}};
    XrScript script;
    int frame = kReady;
    for (const auto& [profile, title] : controllers) script.event(frame += 2, "profile", {{"profile", profile}});
    script.end(frame + 4);
    const XrRun run = this->run(script);
    expect_clean(run);
    script.json["extensions"] = {"XR_KHR_vulkan_enable2"};
    const XrRun without = this->run(script);
    expect_clean(without);
    for (const auto& [profile, title] : controllers) {
        EXPECT_NE(run.log.find(std::string("right hand: ") + title), std::string::npos) << run.log;
        EXPECT_EQ(without.log.find(title), std::string::npos) << without.log;
    }
}

TEST_F(Watching, CheckSaysWhatThereIs) {
    XrScript script;
    script.json["extensions"] = {"XR_KHR_vulkan_enable2", "XR_KHR_visibility_mask"};
    const XrRun run = this->run(script, {"--check"});
    EXPECT_EQ(run.code, 0);
    EXPECT_NE(run.log.find("yes XR_KHR_visibility_mask"), std::string::npos) << run.log;
    EXPECT_NE(run.log.find("no  XR_KHR_composition_layer_depth"), std::string::npos) << run.log;
    for (const char* hand : {"left", "right"})
        EXPECT_NE(run.log.find(fmt::format("{} hand: Meta Touch\n", hand)), std::string::npos) << run.log;
}

// Extensions that the runtime has, and that do nothing with this headset.
TEST_F(Watching, CheckSaysWhatIsReallyThere) {
    with_layer = false;  // it does not know trackers
    XrScript script;
    script.json["profile"] = "";
    script.json["mask"] = false;
    script.json["rates_hz"] = {90};
    const XrRun run = this->run(script, {"--check"});
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.report["violations"], json::array());
    EXPECT_EQ(run.report["destroyed_cleanly"], true);
    for (const char* line :
         {"left hand: no controller", "right hand: no controller", "no  XR_KHR_visibility_mask",
          "no  XR_FB_display_refresh_rate", "no  XR_EXT_local_floor", "no  XR_EXT_hand_interaction",
          "no  XR_HTCX_vive_tracker_interaction", "yes XR_KHR_composition_layer_depth", "STAGE space"})
        EXPECT_NE(run.log.find(line), std::string::npos) << line << "\n" << run.log;
    EXPECT_EQ(run.log.find("yes XR_META_touch_controller_plus"), std::string::npos) << run.log;
}

}  // namespace
}  // namespace neuvv::test
