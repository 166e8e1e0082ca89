// Which performers rays meet on a stage: against the figure's shape, which is known in closed form.
#include "render/clips/stage_pick.h"

#include <gtest/gtest.h>

#include "edit/operations.h"
#include "support/figure.h"
#include "support/gpu_test.h"
#include "support/temporary_folder.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

constexpr double kSize_m = 1.6;
constexpr glm::dvec3 kAnnaAt(-0.8, 0, -2.8), kBenAt(-1.31, 0, -2.0);  // the low corners of their boxes
constexpr glm::dvec3 kEye(0.2, 1.2, -0.3);
constexpr double kLeaf_m = kSize_m / kFigureSide;

glm::dvec3 head_of(glm::dvec3 at, uint32_t frame = 0) {
    return at + kSize_m * (kHead + glm::dvec3(kFigureStep * frame, 0, 0));
}
Ray ray_to(glm::dvec3 target) {
    return {kEye, glm::normalize(target - kEye)};
}
// From the eye to the ball of a head, along the ray through the head's centre.
double distance_to_head(glm::dvec3 head) {
    return glm::distance(kEye, head) - kSize_m * kHeadRadius;
}

// Anna stands behind the upper right corner of ben's box, where ben has no leaf.
struct StagePickTest : GpuTest {
    StagePickTest() {
        voctree::write_nvv(folder.path / "figure.nvv", figure_tree());
        stage::StageFile file = edit::new_stage(folder.path / "stage.gltf");
        for (const auto& [name, at] : {std::pair{"anna", kAnnaAt}, std::pair{"ben", kBenAt}}) {
            edit::PerformerEdit performer;
            performer.clip = folder.path / "figure.nvv";
            edit::Placement placement;
            placement.matrix = glm::translate(glm::dmat4(1), at) * glm::scale(glm::dmat4(1), glm::dvec3(kSize_m));
            edit::add_performer(file, name, performer, placement);
        }
        stage = std::make_unique<stage::Stage>(stage::make_stage(file));
        loader = std::make_unique<render::StageLoader>(device());
        renderer = std::make_unique<render::StageRenderer>(device(), *stage, loader->load(*stage),
                                                           render::FrameCapacity{64, 64});
        evaluated = stage::stage_at(*stage, 0);
    }
    void draw() {
        renderer->show(evaluated);
        renderer->frames().render(look_at(kEye, {-0.3, 0.8, -2}, 64, 64, 1.2), renderer->settings_at(evaluated));
    }
    auto pick(std::initializer_list<Ray> rays) { return render::pick_performers(*renderer, evaluated, rays); }
    std::optional<uint32_t> index_of(const std::string& name) const {
        for (uint32_t i = 0; i < stage->performers.size(); ++i)
            if (stage->performers[i].name == name) return i;
        return std::nullopt;
    }

    TemporaryFolder folder;
    std::unique_ptr<stage::Stage> stage;
    std::unique_ptr<render::StageLoader> loader;
    std::unique_ptr<render::StageRenderer> renderer;
    stage::EvaluatedStage evaluated;
};

// What is picked is not changed by images that are submitted before it is taken.
TEST_F(StagePickTest, PicksAreTakenAfterLaterImages) {
    draw();
    const std::vector<Ray> rays = {ray_to(head_of(kAnnaAt)), ray_to(head_of(kBenAt)), ray_to({1.5, 1, -2})};
    const auto expected = render::pick_performers(*renderer, evaluated, rays);
    ASSERT_TRUE(expected[0] && expected[1] && !expected[2]);
    render::PerformerPicks picks;
    EXPECT_TRUE(picks.take(*renderer).empty()) << "none was begun";
    picks.begin(*renderer, evaluated, rays);
    evaluated = stage::stage_at(*stage, 0.5);
    draw();
    draw();
    renderer->frames().drop_slices();
    renderer->resize(96, 96);
    const auto taken = picks.take(*renderer);
    ASSERT_EQ(taken.size(), rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(taken[i].has_value(), expected[i].has_value()) << i;
        if (!taken[i]) continue;
        EXPECT_EQ(taken[i]->performer, expected[i]->performer);
        EXPECT_EQ(taken[i]->distance_m, expected[i]->distance_m);
    }
    EXPECT_TRUE(picks.take(*renderer).empty()) << "they were taken";
}

TEST_F(StagePickTest, ARayTakesTheSurfaceBehindAnEmptyPartOfANearerBox) {
    const Ray to_anna = ray_to(head_of(kAnnaAt)), to_ben = ray_to(head_of(kBenAt)), beside = ray_to({1.5, 1, -2});
    const auto [low, high] = renderer->leaf_box(0);
    const auto to_box = [&, low = low, high = high](glm::dvec3 at) {
        return box_hit(to_anna, glm::translate(glm::dmat4(1), at) * glm::scale(glm::dmat4(1), glm::dvec3(kSize_m)), low,
                       high);
    };
    ASSERT_TRUE(to_box(kBenAt) && *to_box(kBenAt) < *to_box(kAnnaAt)) << "the scene is what it says";
    draw();
    const auto picked = pick({to_anna, to_ben, beside});
    ASSERT_TRUE(picked[0] && picked[1]);
    EXPECT_EQ(picked[0]->performer, index_of("anna"));
    EXPECT_NEAR(picked[0]->distance_m, distance_to_head(head_of(kAnnaAt)), 2 * kLeaf_m);
    EXPECT_EQ(picked[1]->performer, index_of("ben"));
    EXPECT_NEAR(picked[1]->distance_m, distance_to_head(head_of(kBenAt)), 2 * kLeaf_m);
    EXPECT_FALSE(picked[2]);
}

TEST_F(StagePickTest, TheSurfaceIsThatOfTheTimeThatIsShown) {
    for (const uint32_t frame : {0u, 1u}) {
        evaluated = stage::stage_at(*stage, frame / double{stage->clips[0].fps});
        draw();
        const auto picked = pick({ray_to(head_of(kAnnaAt, frame))});
        ASSERT_TRUE(picked[0]);
        EXPECT_NEAR(picked[0]->distance_m, distance_to_head(head_of(kAnnaAt, frame)), 2 * kLeaf_m) << frame;
    }
}

TEST_F(StagePickTest, TranslucentPerformersAreMetAndHiddenOnesAreNot) {
    for (stage::EvaluatedPerformer& performer : evaluated.performers) performer.opacity = 0.2f;
    draw();
    EXPECT_TRUE(pick({ray_to(head_of(kAnnaAt))})[0]);
    for (stage::EvaluatedPerformer& performer : evaluated.performers) performer.visible = false;
    EXPECT_FALSE(pick({ray_to(head_of(kAnnaAt))})[0]);
}

TEST_F(StagePickTest, BeforeAnImageNothingIsMet) {
    EXPECT_FALSE(pick({ray_to(head_of(kAnnaAt))})[0]);
    draw();
    EXPECT_TRUE(pick({ray_to(head_of(kAnnaAt))})[0]);
}

}  // namespace
}  // namespace neuvv::test
