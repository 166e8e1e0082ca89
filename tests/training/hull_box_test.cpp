// The box around the performer leaves out what only two cameras believe in.
#include "training/tree/hull_box.h"

#include <gtest/gtest.h>

#include "support/look_at.h"
#include "training/tree/first_tree.h"
#include "voctree/voctree.h"

namespace neuvv::test {
namespace {

using Box = std::pair<glm::dvec3, glm::dvec3>;

constexpr double kRadius = 0.15;  // metres, of all balls
const glm::dvec3 kBody(0), kHand(0.8, 0, 0.8);
// Where the rays of the first wide camera to one ball cross those of the second to the other.
const glm::dvec3 kGhosts[] = {{0, 0, 0.8 * 3 / 2.2}, {0.8 * 3 / 2.2, 0, 0}};

Box around(const glm::dvec3& centre, double radius) {
    return {centre - radius, centre + radius};
}

bool is_hit(const stage::Camera& camera, double x, double y, const glm::dvec3& ball) {
    const glm::dvec3 in_camera((x - camera.cx) / camera.fx, -(y - camera.cy) / camera.fy, -1);
    const glm::dvec3 ray = glm::normalize(glm::dmat3(camera.world_from_camera) * in_camera);
    const glm::dvec3 to_ball = ball - glm::dvec3(camera.world_from_camera[3]);
    return glm::length(glm::cross(ray, to_ball)) < kRadius && glm::dot(ray, to_ball) > 0;
}

// Two wide cameras see both balls. Four see little more than the body, and `hand_cameras` little more than the hand,
// all eight from above.
training::Dataset two_balls(uint32_t hand_cameras) {
    training::Dataset dataset;
    dataset.folder = "two balls";
    dataset.times = {0};
    const auto add = [&](const glm::dvec3& eye, const glm::dvec3& target, double focal) {
        dataset.cameras.push_back(look_at(eye, target, 96, 96, focal));
    };
    add({3, 0, 0}, {0, 0, 0}, 1);
    add({0, 0, 3}, {0, 0, 0}, 1);
    for (uint32_t i = 0; i < 4 + hand_cameras; ++i) {
        const double angle = 0.3 + 1.5707963 * i;
        const glm::dvec3 target = i < 4 ? kBody : kHand;
        add(target + glm::dvec3(std::cos(angle), 2.8, std::sin(angle)), target, 3.3);
    }
    dataset.plates.resize(dataset.cameras.size());
    for (uint32_t c = 0; c < dataset.cameras.size(); ++c) {
        media::Image image(96, 96);
        for (uint32_t y = 0; y < 96; ++y)
            for (uint32_t x = 0; x < 96; ++x)
                for (const glm::dvec3& ball : {kBody, kHand})
                    if (is_hit(dataset.cameras[c], x + 0.5, y + 0.5, ball))
                        std::fill_n(image.at(x, y), 4, uint8_t{255});
        dataset.views.push_back({"c" + std::to_string(c), c, 0, training::TiledImage(image)});
    }
    return dataset;
}

TEST(HullBox, LeavesOutWhatNoPixelNeeds) {
    const training::Dataset dataset = two_balls(4);
    const training::MatterGrid grid = training::find_matter(dataset);
    EXPECT_TRUE(grid.overlaps(around(kBody, 0.01)));
    EXPECT_TRUE(grid.overlaps(around(kHand, 0.01)));
    for (const glm::dvec3& ghost : kGhosts) {
        ASSERT_EQ(training::carve(dataset, {{glm::vec3(ghost), 0.02f}})[0], 1u) << "no ghost, so nothing is tested";
        EXPECT_FALSE(grid.overlaps(around(ghost, 0.1)));
    }
    for (const int axis : {0, 2}) {
        EXPECT_LE(grid.tight_box.first[axis], -kRadius);
        EXPECT_GE(grid.tight_box.second[axis], 0.8 + kRadius);
        EXPECT_LT(grid.tight_box.second[axis], 0.8 + kRadius + 0.1);
    }
}

TEST(HullBox, FirstLeavesAreOnlyWhereMatterIs) {
    const voctree::VOctree tree =
        training::initial_tree(two_balls(4), {.resolution = 64, .bases = 1, .hh_degree = 0}, 2);
    size_t at_hand = 0;
    for (const voctree::LeafPosition& p : voctree::leaf_positions(tree)) {
        const double edge = static_cast<double>(tree.box_size.x) / (1u << p.depth);
        const glm::dvec3 centre = glm::dvec3(tree.box_min) + edge * (glm::dvec3(p.x, p.y, p.z) + 0.5);
        for (const glm::dvec3& ghost : kGhosts) EXPECT_GT(glm::length(centre - ghost), kRadius);
        at_hand += glm::length(centre - kHand) < kRadius ? 1 : 0;
    }
    EXPECT_GT(at_hand, 0u);
}

// Only the two wide cameras see the hand, but without it some of their pixels would have nothing on their rays.
TEST(HullBox, KeepsWhatPixelsNeedHoweverFewSeeIt) {
    const training::MatterGrid grid = training::find_matter(two_balls(0));
    EXPECT_TRUE(grid.overlaps(around(kBody, 0.01)));
    EXPECT_TRUE(grid.overlaps(around(kHand, 0.01)));
}

// The box with which the search begins holds what close-ups show that do not look at the centre.
TEST(HullBox, BeginsWithAllThatImagesShow) {
    training::Dataset dataset = two_balls(4);
    for (uint32_t c = 0; c < 2; ++c) dataset.cameras[c].fx = dataset.cameras[c].fy = 400;  // close-ups of the body
    const Box box = training::first_box(dataset);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LT(box.first[axis], kBody[axis] - kRadius);
        EXPECT_GT(box.second[axis], kHand[axis] + kRadius);
    }
}

}  // namespace
}  // namespace neuvv::test
