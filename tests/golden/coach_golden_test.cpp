// A trainer with red limbs against the committed images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>

#include "golden/golden.h"
#include "motion/compare/compare.h"
#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/trainee.h"
#include "render/frame/frame_renderer.h"
#include "support/body_tree.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/temporary_folder.h"
#include "tools/motion/coach_drawing.h"
#include "tools/motion/motion_page.h"

namespace neuvv::test {
namespace {

using motion::Limb;

constexpr uint32_t kCoachWidth = 256, kCoachHeight = 192;
constexpr double kCoachTime_s = 1.5;  // of the clip

struct CoachGolden : GpuTest {
    const motion::SkeletonClip dancer = performer_motion(75);
    const glm::dvec3 centre =
        motion::at(motion::pose_at(dancer, kCoachTime_s* dancer.fps), motion::Joint::kPelvis).position;
    const voctree::VOctree tree = body_tree(dancer, 2, static_cast<float>(1 / kCoachTime_s));
    render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer{device(), field, {kCoachWidth, kCoachHeight, 2}};

    // From the front and a little above, at a point over the pelvis.
    stage::Camera camera(double distance_m, double above_m) const {
        const glm::dvec3 target = centre + glm::dvec3(0, above_m, 0);
        return look_at(target + distance_m * glm::dvec3(0.25, 0.2, 1), target, kCoachWidth, kCoachHeight, 1.1);
    }
    media::Image image(const std::vector<render::Instance>& instances, const stage::Camera& seen_by) {
        render::FrameSettings settings;
        settings.instances = instances;
        settings.width = kCoachWidth;
        settings.height = kCoachHeight;
        settings.samples = 2;
        settings.mode = render::TraceMode::kPlay;
        settings.resolve.background = {0.18f, 0.21f, 0.25f, 1};
        return renderer.render(seen_by, settings);
    }
    render::Instance instance(double x_m, std::shared_ptr<const render::Highlight> highlight = nullptr) const {
        render::Instance one{1, glm::translate(glm::mat4(1), {static_cast<float>(x_m), 0, 0})};
        one.highlight = std::move(highlight);
        return one;
    }
};

// Two copies of a dancer at the same time. The left arm of the one on the left is orange (yellow that is tinted) and
// its right leg is dark red; the copy has its own colours, a yellow arm and a dark grey leg.
TEST_F(CoachGolden, AHighlightedBodyBesideAnUntouchedCopy) {
    const motion::Pose pose = motion::pose_at(dancer, kCoachTime_s * dancer.fps);
    coach::LimbValues red{};
    red[motion::index_of(Limb::kLeftArm)] = red[motion::index_of(Limb::kRightLeg)] = 1;
    const auto highlight =
        std::make_shared<const render::Highlight>(coach::highlight_of(coach::body_of(pose, height_of(dancer)), red));
    const stage::Camera seen_by = camera(3, 0);
    const media::Image both = image({instance(-0.6, highlight), instance(0.6)}, seen_by);
    EXPECT_EQ(check_golden("coach_highlight", both), "");
    const media::Image plain = image({instance(-0.6), instance(0.6)}, seen_by);
    EXPECT_FALSE(compare_with_golden(plain, both).passes()) << "nothing is red";
    for (uint32_t y = 0; y < kCoachHeight; ++y)
        for (uint32_t x = kCoachWidth * 5 / 9; x < kCoachWidth; ++x)
            ASSERT_TRUE(std::equal(both.at(x, y), both.at(x, y) + 4, plain.at(x, y))) << x << ", " << y;
}

// What `neuvv coach` draws: the dancer with a red right arm; the trainee's bones inside of it in light blue, those of
// the arm, which is raised too far, in orange; yellow arrows from the trainee's elbow and wrist to the dancer's; and at
// the top left the score over "RIGHT ARM: 42 DEG OFF".
TEST_F(CoachGolden, ATraineesGhostArrowsAndRemarks) {
    const motion::SkeletonClip trainee =
        other_body(with_arm_off(dancer, Limb::kRightArm, 40, 0.8, 3), 0.9, {2, 0, 1}, 0.7);
    coach::Coach coach(dancer, {.mode = coach::Mode::kPerform});
    for (int i = 0; i <= 50 * kCoachTime_s; ++i) {
        const double t = i / 50.0;
        coach.update(motion::TimedPose{t, motion::pose_at(trainee, t * trainee.fps)}, t, t);
    }
    const stage::Camera seen_by = camera(3.2, 0.3);
    const auto drawn = [&](const std::shared_ptr<const render::Highlight>& highlight) {
        media::Image over = image({instance(0, highlight)}, seen_by);
        tools::draw_guide(over, seen_by, glm::dmat4(1), coach);
        tools::draw_remarks(over, coach);
        return over;
    };
    const media::Image shown = drawn(coach.highlight());
    EXPECT_EQ(check_golden("coach_guide", shown), "");
    EXPECT_FALSE(compare_with_golden(drawn(nullptr), shown).passes()) << "the arm is not red";
    coach.change({.mode = coach::Mode::kPerform, .ghost = false, .arrows = false});
    EXPECT_FALSE(compare_with_golden(drawn(coach.highlight()), shown).passes()) << "no lines are drawn";
}

// The report of the recorded trainee of tools/performer: its text, curves and stick figures, character by character.
TEST(CoachReport, SaysAndDrawsWhatItDid) {
    const motion::SkeletonClip dancer = performer_motion(75);
    const motion::SkeletonClip trainee = motion::read_skeleton(NEUVV_SOURCE_DIR "/tools/performer/trainee.glb");
    const motion::CompareOptions options;
    const std::string page = tools::motion_page({"dancer", "trainee"}, dancer, trainee,
                                                motion::compare(dancer, trainee, options), options.tolerances);
    const std::filesystem::path golden = NEUVV_GOLDEN_DIR "/coach_report.html";
    const char* accept = std::getenv("NEUVV_ACCEPT_GOLDEN");
    if (accept && (std::string(accept) == "coach_report" || std::string(accept) == "all")) write_text(golden, page);
    const std::string truth = read_text(golden);
    const auto [differs, expected] = std::ranges::mismatch(page, truth);
    const auto at = differs - page.begin();
    EXPECT_EQ(page, truth) << "from character " << at << ": "
                           << page.substr(static_cast<size_t>(std::max<std::ptrdiff_t>(0, at - 40)), 80)
                           << "\nNEUVV_ACCEPT_GOLDEN=coach_report accepts the new page; look at it in a browser first";
}

}  // namespace
}  // namespace neuvv::test
