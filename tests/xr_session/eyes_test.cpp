// The images of the eyes: their format and size.
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
    for (size_t i = 0; i < a.rgba.size(); i++) sum += std::abs(a.rgba[i] - b.rgba[i]);
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

}  // namespace
}  // namespace neuvv::test
