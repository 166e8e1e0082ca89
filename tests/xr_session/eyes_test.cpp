// The images of the eyes: their format and size, where they are sharp, and what is behind the stage.
#include "edit/operations.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Eyes : XrSession {};

TEST_F(Eyes, AreOf8BitsWhateverTheRuntimePrefers) {
    XrScript script;
    script.save(4);
    script.end(6);
    const XrRun plain = run(script);
    EXPECT_EQ(plain.report["layers"][0]["format"], "R8G8B8A8_SRGB");
    // The order of Monado, which prefers floats.
    script.json["formats"] = {"R16G16B16A16_SFLOAT", "B8G8R8A8_SRGB", "R8G8B8A8_SRGB", "D32_SFLOAT"};
    const XrRun other = run(script);
    expect_clean(other);
    EXPECT_EQ(other.report["layers"][0]["format"], "B8G8R8A8_SRGB");
    EXPECT_TRUE(same_pixels(plain.image(4, "left_seen"), other.image(4, "left_seen")));
}

double mean_difference(const media::Image& a, const media::Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) sum += std::abs(a.rgba[i] - b.rgba[i]);
    return sum / static_cast<double>(a.rgba.size());
}

TEST_F(Eyes, DrawASmallerRectangleWhereTimeIsShort) {
    constexpr int kSaved = 80;
    XrScript script;
    script.hand(0, "left", kLeftHand, {-3, 1, -4});
    script.hand(0, "right", kRightHand, kAnna);
    script.click(kReady, "left", "y/click");
    script.save(kSaved);
    script.end(kSaved + 2);
    scale = "";
    script.json["refresh_hz"] = 0.2;
    const XrRun slow = run(script);
    expect_clean(slow);
    script.json["refresh_hz"] = 2000;
    const XrRun fast = run(script);
    expect_clean(fast);
    EXPECT_EQ(slow.report["layers"][0]["size"], json({192, 192}));
    EXPECT_EQ(fast.report["layers"][0]["size"], json({96, 96}));
    // The user sees the same, but blurred: stage, lens, panel and its hole are where they are in the whole image.
    for (const char* eye : {"left_seen", "right_seen"})
        EXPECT_LT(mean_difference(slow.image(kSaved, eye), fast.image(kSaved, eye)), 6) << eye;
    const media::Image depth = fast.image(kSaved, "left_depth");
    EXPECT_EQ(depth.width, 96u);
}

// Pixels of a part of an image, within `radius` of (x, y), that differ clearly.
uint32_t differing(const media::Image& a, const media::Image& b, int x, int y, int radius) {
    uint32_t count = 0;
    for (int v = y - radius; v <= y + radius; ++v)
        for (int u = x - radius; u <= x + radius; ++u)
            for (int c = 0; c < 3; ++c)
                if (std::abs(a.at(u, v)[c] - b.at(u, v)[c]) > 8) {
                    ++count;
                    break;
                }
    return count;
}

// An inset that takes a quarter of the side has all rays; beside it there are half as many per side.
TEST_F(Eyes, AreSharpWhereTheyLook) {
    constexpr int kAtFeet = 8, kLost = 12, kRadius = 18;
    XrScript script;
    script.json["profile"] = "";
    script.json["gaze"] = true;
    script.gaze(0, {0, 1.5, 0}, {0, 0.1, -2});
    script.lose_gaze(kAtFeet + 2);
    for (const int frame : {kAtFeet, kLost}) script.save(frame);
    script.end(kLost + 2);
    const XrRun whole = run(script), inset = run(script, {"--inset", "0.25"});
    expect_clean(inset);
    for (const auto& [frame, sharp_y, blurred_y] : {std::tuple{kAtFeet, 142, 89}, std::tuple{kLost, 89, 142}}) {
        SCOPED_TRACE(frame);
        for (const auto& [eye, x] : {std::pair{"left", 104}, std::pair{"right", 87}}) {
            const media::Image a = whole.image(frame, eye), b = inset.image(frame, eye);
            EXPECT_LT(differing(a, b, x, sharp_y, kRadius), 5u) << eye;
            EXPECT_GT(differing(a, b, x, blurred_y, kRadius), 20u) << eye;
        }
    }
    // Without the extension, and with it on a headset that does not track eyes, it is in the centre from the start.
    script.json["gaze"] = false;
    const media::Image lost = inset.image(kLost, "left");
    EXPECT_TRUE(same_pixels(run(script, {"--inset", "0.25"}).image(kAtFeet, "left"), lost));
    script.json["extensions"] = {"XR_KHR_vulkan_enable2", "XR_KHR_visibility_mask", "XR_EXT_eye_gaze_interaction"};
    EXPECT_TRUE(same_pixels(run(script, {"--inset", "0.25"}).image(kAtFeet, "left"), lost));
}

// Four views: two wide ones of 128 × 128 pixels, and two narrow ones of 192 × 192.
struct NarrowViews : Eyes {
    NarrowViews() {
        script.json["profile"] = "";
        for (const char* side : {"width", "height"}) script.json[side] = 128;
        script.json["narrow_views"] = {{"width", 192}, {"height", 192}, {"fov_deg", fov}};
        script.save(kSaved);
        script.end(kSaved + 2);
    }
    // A session with two views, of this field of view, and images of 192 × 192 pixels.
    XrRun stereo(const json& fov_deg) {
        XrScript two;
        two.json["profile"] = "";
        two.json["fov_deg"] = fov_deg;
        two.save(kSaved);
        two.end(kSaved + 2);
        return run(two, {"--no-mask"});
    }
    static constexpr int kSaved = 8;
    const json fov = {{-13, 11, 12, -14}, {-11, 13, 12, -14}};
    XrScript script;
};

TEST_F(NarrowViews, AreDrawnOverTheWideOnes) {
    const XrRun four = run(script, {"--no-mask"});
    expect_clean(four);
    EXPECT_EQ(four.report["layers"][0]["fov_deg"].size(), 4u);
    EXPECT_EQ(four.report["layers"][0]["size"], json({192, 192}));
    const XrRun narrow = stereo(fov), wide = stereo(script.json["fov_deg"]);
    for (const std::string eye : {"left", "right"}) {
        SCOPED_TRACE(eye);
        EXPECT_TRUE(same_pixels(four.image(kSaved, eye + "_narrow"), narrow.image(kSaved, eye)))
            << "a ray in each pixel";
        EXPECT_FALSE(same_pixels(four.image(kSaved, eye), wide.image(kSaved, eye))) << "fewer rays than pixels";
        EXPECT_LT(mean_difference(four.image(kSaved, eye), wide.image(kSaved, eye)), 3) << "but the same";
        EXPECT_EQ(four.image(kSaved, eye + "_narrow_depth").width, 192u);
    }
}

TEST_F(NarrowViews, HaveShapesAndMasksOfTheirOwn) {
    script.json.erase("profile");
    script.json["narrow_views"]["fov_deg"] = {{-10, 37, 12, -40}, {-10, 41, 12, -40}};  // right below, at the mask
    script.hand(0, "right", kRightHand, kAnna);
    const XrRun four = run(script);
    expect_clean(four);
    script.json["mask"] = false;
    const XrRun unmasked = run(script);
    script.json["mask"] = true;
    script.lose(0, "right");
    const XrRun bare = run(script);
    for (const char* view : {"left", "right", "left_narrow", "right_narrow"}) {
        EXPECT_FALSE(same_pixels(four.image(kSaved, view), unmasked.image(kSaved, view))) << view;
        EXPECT_FALSE(same_pixels(four.image(kSaved, view), bare.image(kSaved, view))) << view;
    }
}

TEST_F(NarrowViews, FollowTheGazeWhileItIsTracked) {
    constexpr int kLost = 14;
    script.json["gaze"] = true;
    script.gaze(0, {0, 1.5, 0}, {0, 0.3, -2});
    script.lose_gaze(kLost - 2);
    script.save(kLost);
    script.end(kLost + 2);
    const XrRun four = run(script, {"--no-mask"});
    expect_clean(four);
    const json looked = four.report["layers"][0]["fov_deg"][2], still = four.report["layers"][1]["fov_deg"][2];
    EXPECT_LT(looked[2].get<double>(), still[2].get<double>() - 10) << "down to the feet";
    for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(still[i].get<double>(), fov[0][i].get<double>(), 1e-3);
    const json two = {looked, four.report["layers"][0]["fov_deg"][3]};
    EXPECT_TRUE(same_pixels(four.image(kSaved, "left_narrow"), stereo(two).image(kSaved, "left")));
    EXPECT_FALSE(same_pixels(four.image(kSaved, "left"), four.image(kLost, "left")))
        << "the runtime recommends fewer pixels for wide views meanwhile";
}

TEST_F(NarrowViews, AreLeftOutByStereo) {
    const XrRun four = run(script, {"--inset", "0.5"});
    expect_clean(four);
    EXPECT_NE(four.log.find("--inset is not used"), std::string::npos) << four.log;
    const XrRun two = run(script, {"--stereo"});
    expect_clean(two);
    EXPECT_EQ(two.report["layers"][0]["fov_deg"].size(), 2u);
    EXPECT_EQ(two.report["layers"][0]["size"], json({128, 128}));
    script.json["gaze"] = true;
    const std::string check = run(script, {"--check"}).log, stereo_check = run(script, {"--check", "--stereo"}).log;
    EXPECT_NE(check.find("narrow view while the eyes are tracked, where they look: 192x192"), std::string::npos)
        << check;
    EXPECT_EQ(stereo_check.find("narrow view of each eye, in the centre"), std::string::npos) << stereo_check;
}

// The share of a part of an image whose alpha is above `alpha`.
double covered(const media::Image& image, uint32_t left, uint32_t top, uint32_t right, uint32_t bottom, int alpha) {
    uint32_t count = 0;
    for (uint32_t y = top; y < bottom; ++y)
        for (uint32_t x = left; x < right; ++x) count += image.at(x, y)[3] > alpha;
    return count / double((right - left) * (bottom - top));
}

struct Room : Eyes {
    Room() {
        script.json["profile"] = "";
        script.save(6);
        script.end(8);
        stage::StageFile file = stage::read_stage_file(stage);
        edit::StageEdit edit;
        edit.background = glm::dvec3(0.2, 0.5, 0.9);
        edit::set_stage(file, edit);
        stage::save_stage_file(file, stage);
    }
    XrScript script;
};

// Below anna, who stands 2 m away, the floor is dark; the rest of it, the disk that is the set, and the background are
// not there.
void expect_only_anna_and_her_shadow(const media::Image& seen) {
    EXPECT_GT(covered(seen, 86, 80, 102, 110, 250), 0.5) << "anna";
    EXPECT_EQ(covered(seen, 0, 0, 192, 30, 0), 0) << "no background";
    EXPECT_EQ(covered(seen, 60, 175, 130, 192, 0), 0) << "no floor";
    uint32_t shadow = 0;
    for (size_t i = 0; i < seen.rgba.size(); i += 4) {
        const uint8_t* pixel = &seen.rgba[i];
        shadow += pixel[3] > 40 && pixel[3] < 250 && pixel[0] + pixel[1] + pixel[2] == 0;
    }
    EXPECT_GT(shadow, 150u);
}

TEST_F(Room, IsSeenByAlphaBlendEvenIfThatIsNotPreferred) {
    const XrRun plain = run(script, {"--no-mask"});
    EXPECT_EQ(covered(plain.image(6, "left"), 0, 0, 192, 192, 254), 1);
    EXPECT_EQ(plain.seen["room"], "hidden");
    script.json["blend_modes"] = {"opaque", "alpha_blend"};
    EXPECT_EQ(run(script).report["layers"][0]["blend"], "opaque") << "the user did not ask for it";
    const XrRun room = run(script, {"--no-mask", "--room"});
    expect_clean(room);
    EXPECT_EQ(room.report["layers"][0]["blend"], "alpha_blend");
    expect_only_anna_and_her_shadow(room.image(6, "left"));
}

TEST_F(Room, IsSeenFromTheStartWhereTheRuntimePrefersIt) {
    script.json["blend_modes"] = {"alpha_blend", "opaque"};
    const XrRun room = run(script, {"--no-mask"});
    expect_clean(room);
    EXPECT_EQ(room.report["layers"][0]["blend"], "alpha_blend");
    expect_only_anna_and_her_shadow(room.image(6, "left"));
}

TEST_F(Room, IsSeenByPassthrough) {
    with_layer = false;  // that of Debian 12 does not know the layer of the passthrough
    script.json["passthrough"] = true;
    EXPECT_EQ(run(script).report["layers"][0]["types"], json({"projection"})) << "the user did not ask for it";
    const XrRun room = run(script, {"--no-mask", "--room"});
    expect_clean(room);
    EXPECT_EQ(room.report["layers"][0]["types"], json({"passthrough", "projection"}));
    EXPECT_EQ(room.report["layers"][0]["blend"], "opaque");
    EXPECT_EQ(room.seen["room"], "XR_FB_passthrough");
    EXPECT_NE(run(script, {"--check"}).log.find("your own room: XR_FB_passthrough"), std::string::npos);
    expect_only_anna_and_her_shadow(room.image(6, "left"));
    script.json["passthrough"] = false;
    script.json["blend_modes"] = {"alpha_blend", "opaque"};
    EXPECT_TRUE(same_pixels(run(script, {"--no-mask"}).image(6, "left_seen"), room.image(6, "left_seen")))
        << "both ways show the same";
}

TEST_F(Room, IsShownAndHiddenByThePanel) {
    with_layer = false;  // that of Debian 12 does not know the layer of the passthrough
    XrScript to_panel;
    to_panel.json["passthrough"] = true;
    to_panel.hand(0, "left", kLeftHand, {-3, 1, -4});
    to_panel.hand(0, "right", kRightHand, kAnna);
    to_panel.click(kReady, "left", "y/click");
    press(to_panel, 10, panel_after(to_panel, 14), "user page");
    const json items = panel_after(to_panel, 10 + kPress + 2);
    XrScript pressed = to_panel;
    for (const int frame : {20, 30}) {
        press(pressed, frame, items, "room");
        pressed.save(frame + kPress);
    }
    pressed.end(40);
    const XrRun run = this->run(pressed);
    expect_clean(run);
    EXPECT_EQ(run.report["layers"][0]["types"], json({"passthrough", "quad", "projection"}));
    EXPECT_EQ(run.report["layers"][1]["types"], json({"quad", "projection"}));
}

TEST_F(Room, IsKeptFromRunToRun) {
    script.json["blend_modes"] = {"opaque", "alpha_blend"};
    EXPECT_EQ(run(script, {"--room"}).report["layers"][0]["blend"], "alpha_blend");
    const XrRun again = run(script);
    expect_clean(again);
    EXPECT_EQ(again.report["layers"][0]["blend"], "alpha_blend");
    script.json["blend_modes"] = {"opaque"};
    for (int i = 0; i < 2; ++i)
        EXPECT_NE(run(script).log.find("cannot show your room"), std::string::npos) << "a headset that cannot show it";
    script.json["blend_modes"] = {"opaque", "alpha_blend"};
    EXPECT_EQ(run(script).report["layers"][0]["blend"], "alpha_blend") << "does not change what the user wants";
}

TEST_F(Room, HasAShadowEvenWithoutLights) {
    stage = clip;  // on a stage of its own, without set and lights
    script.json["blend_modes"] = {"opaque", "alpha_blend"};
    const media::Image alone = run(script, {"--no-mask"}).image(6, "left");
    const XrRun room = run(script, {"--no-mask", "--room"});
    expect_clean(room);
    const media::Image seen = room.image(6, "left");
    uint32_t shadow = 0, figure = 0, changed = 0;
    for (size_t i = 0; i < seen.rgba.size(); i += 4) {
        const bool black = seen.rgba[i] + seen.rgba[i + 1] + seen.rgba[i + 2] == 0;
        shadow += black && seen.rgba[i + 3] > 10 && seen.rgba[i + 3] < 200;
        if (seen.rgba[i + 3] != 255) continue;
        ++figure;
        for (size_t c = 0; c < 3; ++c) changed += std::abs(seen.rgba[i + c] - alone.rgba[i + c]) > 1;
    }
    EXPECT_GT(shadow, 15u);
    EXPECT_GT(figure, 200u);
    EXPECT_EQ(changed, 0u) << "the performer has the light that it has without the room";
}

TEST_F(Room, ComesBackWhereThePassthroughWasLost) {
    with_layer = false;  // that of Debian 12 does not know the layer of the passthrough
    script.json["passthrough"] = true;
    script.event(4, "passthrough_lost");
    const XrRun room = run(script, {"--room"});
    expect_clean(room);
    EXPECT_EQ(room.report["layers"][0]["types"], json({"passthrough", "projection"}));
}

TEST_F(Room, GoesOnWhereThePassthroughIsRefused) {
    with_layer = false;  // that of Debian 12 does not know the layer of the passthrough
    script.json["passthrough"] = true;
    for (const char* function : {"xrCreatePassthroughFB", "xrCreatePassthroughLayerFB"}) {
        script.json["fail"] = {{{"function", function}, {"result", "XR_ERROR_FEATURE_UNSUPPORTED"}}};
        const XrRun room = run(script, {"--room"});
        expect_clean(room);
        EXPECT_EQ(room.report["layers"][0]["types"], json({"projection"}));
        EXPECT_NE(room.log.find("cannot show your room"), std::string::npos) << room.log;
    }
}

TEST_F(Room, SaysWhereTheHeadsetCannotShowIt) {
    const XrRun room = run(script, {"--room"});
    expect_clean(room);
    EXPECT_EQ(room.seen["room"], "hidden");
    EXPECT_NE(room.log.find("cannot show your room"), std::string::npos) << room.log;
    EXPECT_NE(run(script, {"--check"}).log.find("your own room: not possible"), std::string::npos);
}

}  // namespace
}  // namespace neuvv::test
