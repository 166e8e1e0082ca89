// Pointing at performers: what the ray meets is what it takes.
#include "edit/operations.h"
#include "support/figure.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

struct Pointing : XrSession {
    // The ray from kRightHand to anna's head goes through the upper right part of ben's box, where ben has no leaf. The
    // user stands at kStart, below the camera, as ben is nearer than anna.
    static constexpr glm::dvec3 kStart = glm::dvec3(0, 0, 1);
    void add_ben() const {
        stage::StageFile file = stage::read_stage_file(stage);
        add_figure(file, "ben", {-1.31, 0, -2});
        edit::Placement placement;
        placement.move = kStart;
        edit::place_node(file, edit::find_node(file, "camera"), placement);
        stage::save_stage_file(file, stage);
    }
    static constexpr glm::dvec3 kAnnaHead = glm::dvec3(-0.08, 0.992, -2), kBenHead = glm::dvec3(-0.59, 0.992, -1.2);
    static XrScript clicking_at(glm::dvec3 target) {
        XrScript script;
        script.hand(0, "right", kRightHand, target - kStart);
        script.hand(0, "left", kLeftHand, {-3, 1, -4});
        script.click(kReady + 2, "right", "trigger/value");
        script.end(kReady + 8);
        return script;
    }
};

TEST_F(Pointing, ARayTakesThePerformerWhoseSurfaceItMeets) {
    add_ben();
    const XrRun anna = run(clicking_at(kAnnaHead)), ben = run(clicking_at(kBenHead));
    expect_clean(anna);
    expect_clean(ben);
    EXPECT_EQ(anna.seen["selected"], "anna") << "ben's box is nearer, but he is beside the ray";
    EXPECT_EQ(ben.seen["selected"], "ben");
}

// Nobody is selected, so B copies nothing.
TEST_F(Pointing, AnErrorIsInViewAndFeltTwiceInBothHands) {
    XrScript script;
    script.hand(0, "right", kRightHand, {3, 4, -4});
    script.hand(0, "left", kLeftHand, {-3, 4, 0});
    script.save(kReady);
    script.click(kReady + 2, "right", "b/click");
    script.save(kReady + 10);
    script.end(kReady + 32);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(run.seen["notice"][0], "point at a performer and select");
    std::map<std::string, std::vector<int>> felt;
    for (const nlohmann::json& pulse : run.report["haptics"]) {
        felt[pulse["path"]].push_back(pulse["frame"]);
        EXPECT_EQ(pulse["amplitude"], 1) << pulse;
    }
    ASSERT_EQ(felt.size(), 2u) << run.report["haptics"];
    for (const auto& [path, frames] : felt) {
        ASSERT_EQ(frames.size(), 2u) << run.report["haptics"];
        EXPECT_NEAR(frames[1] - frames[0], 0.24 * 90, 1) << path;
    }
    EXPECT_FALSE(same_pixels(run.image(kReady, "left"), run.image(kReady + 10, "left"), 12)) << "the plate";
}

// The brightest and darkest luma in a part of an image, whose corners are in pixels.
std::pair<int, int> contrast(const media::Image& image, glm::ivec2 low, glm::ivec2 high) {
    std::pair range{255, 0};
    for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x) {
            const uint8_t* pixel = image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y));
            const int luma = (pixel[0] + 2 * pixel[1] + pixel[2]) / 4;
            range = {std::min(range.first, luma), std::max(range.second, luma)};
        }
    return range;
}

// Where an eye of the script sees a point, in pixels. The head is where scripts begin with it.
glm::ivec2 pixel_of(const XrScript& script, int eye, glm::dvec3 point) {
    const glm::dquat turned = glm::angleAxis(std::atan2(-0.3, 2.0), glm::dvec3(1, 0, 0));
    const glm::dvec3 at = glm::conjugate(turned) * (point - glm::dvec3(eye == 0 ? -0.032 : 0.032, 1.5, 0));
    const auto& fov = script.json["fov_deg"][static_cast<size_t>(eye)];
    const auto tangent = [&](size_t i) { return std::tan(glm::radians(fov[i].get<double>())); };
    const glm::dvec2 seen(at.x / -at.z, at.y / -at.z);
    return glm::dvec2((seen.x - tangent(0)) / (tangent(1) - tangent(0)) * script.json["width"].get<double>(),
                      (seen.y - tangent(2)) / (tangent(3) - tangent(2)) * script.json["height"].get<double>());
}

TEST_F(Pointing, TheNameOfWhomARayHitsIsAtItsEnd) {
    XrScript script;
    script.json["width"] = script.json["height"] = 1024;  // 13 pixels a degree, fewer than headsets have
    script.hand(0, "right", kRightHand, kAnnaHead);
    script.hand(0, "left", kLeftHand, {-3, 4, 0});
    script.save(kReady + 2);
    script.hand(kReady + 4, "right", kRightHand, {3, 4, -4});
    script.save(kReady + 6);
    script.end(kReady + 8);
    const XrRun run = this->run(script, {"--no-mask"});
    expect_clean(run);
    const glm::dvec3 dot = kAnnaHead + 1.6 * kHeadRadius * glm::normalize(kRightHand - kAnnaHead);  // on the head
    for (const int which : {0, 1}) {
        const char* eye = which == 0 ? "left" : "right";
        const glm::ivec2 at = pixel_of(script, which, dot);
        const glm::ivec2 low = at - glm::ivec2(24, 32), high = at + glm::ivec2(24, -8);  // a plate above the dot
        const auto [dark, bright] = contrast(run.image(kReady + 2, eye), low, high);
        EXPECT_GT(bright, 190) << eye << ": letters";
        EXPECT_LT(dark, 100) << eye << ": on a plate";
        const auto [body_dark, body_bright] = contrast(run.image(kReady + 6, eye), low, high);
        EXPECT_LT(body_bright - body_dark, 60) << eye << ": where no ray points is no name";
    }
}

}  // namespace
}  // namespace neuvv::test
