// Several people in the images of several cameras: who is who.
#include "motion/video/people.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "motion/detector.h"
#include "motion/video/extract.h"

namespace neuvv {
namespace {

constexpr size_t kPeopleFrames = 40, kPeopleViews = 4;

// The performer, and another one who does the same earlier, moves past the first and faces elsewhere.
motion::SkeletonClip passer_by() {
    motion::SkeletonClip clip = test::performer_motion(kPeopleFrames + 20);
    clip.frames.erase(clip.frames.begin(), clip.frames.begin() + 20);
    for (size_t f = 0; f < kPeopleFrames; ++f)
        for (motion::JointSample& sample : clip.frames[f]) {
            const glm::dvec3 p = sample.position;
            sample.position = glm::dvec3(-p.z, p.y, p.x) + glm::dvec3(-1.5 + 0.075 * double(f), 0, 0.8);
        }
    return clip;
}

struct TwoPeople {
    std::array<motion::SkeletonClip, 2> truth = {test::performer_motion(kPeopleFrames), passer_by()};
    std::array<motion::Detections, 2> each;
    motion::Detections seen;  // both

    explicit TwoPeople(const test::DetectorErrors& errors, uint32_t seed) {
        const auto cameras = test::cameras_around(truth[0], kPeopleViews);
        for (size_t p = 0; p < 2; ++p) each[p] = test::detect(truth[p], cameras, errors, seed + uint32_t(p));
        seen = each[0];
        seen.people.resize(seen.points.size());
        std::mt19937 random(seed);
        for (size_t i = 0; i < seen.points.size(); ++i) {
            seen.people[i] = {each[0].points[i], each[1].points[i]};
            if (random() % 2 == 0) std::swap(seen.people[i][0], seen.people[i][1]);
            seen.points[i] = seen.people[i][0];
        }
    }
    // In how many images a person that was found has the key points of the one or the other.
    std::array<size_t, 2> images_of(const motion::Person& person) const {
        std::array<size_t, 2> images{};
        for (size_t i = 0; i < person.points.size(); ++i)
            for (size_t p = 0; p < 2; ++p)
                images[p] += std::ranges::equal(person.points[i], each[p].points[i],
                                                [](const motion::KeyPoint& a, const motion::KeyPoint& b) {
                                                    return a.pixel == b.pixel && a.confidence == b.confidence;
                                                });
        return images;
    }
};

TEST(People, AreToldApartByTheViewsThatAgree) {
    for (const uint32_t seed : {1u, 2u, 3u}) {
        TwoPeople test({}, seed);
        test.seen.people[7].clear();  // a view in which nobody was seen
        std::vector<motion::Person> people = motion::find_people(test.seen);
        ASSERT_EQ(people.size(), 2u) << seed;
        if (test.images_of(people[0])[0] < test.images_of(people[1])[0]) std::swap(people[0], people[1]);
        for (size_t p = 0; p < 2; ++p) {
            const std::array<size_t, 2> images = test.images_of(people[p]);
            EXPECT_EQ(images[1 - p], 0u) << "seed " << seed << ", person " << p;
            EXPECT_GT(images[p], kPeopleFrames * kPeopleViews * 95 / 100);
            EXPECT_EQ(people[p].frames, kPeopleFrames);
            motion::Detections alone = test.each[p];
            alone.points = people[p].points;
            const double error = test::error_of(motion::extract_skeleton(alone, {}).clip, test.truth[p]).mean;
            const double by_itself =
                test::error_of(motion::extract_skeleton(test.each[p], {}).clip, test.truth[p]).mean;
            EXPECT_LT(error, 1.1 * by_itself);
        }
        EXPECT_NEAR(people[1].place.z, 0.8, 0.3);
    }
}

TEST(People, GoOnWhereNoViewShowsThemForAWhile) {
    TwoPeople test({0.005, 0.1, 0, 0}, 4);
    for (size_t f = 15; f < 25; ++f)
        for (size_t c = 0; c < kPeopleViews; ++c)
            test.seen.people[f * kPeopleViews + c] = {test.each[1].points[f * kPeopleViews + c]};
    const std::vector<motion::Person> people = motion::find_people(test.seen);
    ASSERT_EQ(people.size(), 2u);
    EXPECT_EQ(people[0].frames, kPeopleFrames);
    EXPECT_EQ(people[1].frames, kPeopleFrames - 10);
    EXPECT_EQ(test.images_of(people[1])[1], 0u);
}

TEST(People, NeedTwoViewsThatAgree) {
    TwoPeople test({0, 0, 0, 0}, 5);
    for (size_t i = 0; i < test.seen.people.size(); ++i)
        if (i % kPeopleViews != 2) test.seen.people[i].clear();
    EXPECT_TRUE(motion::find_people(test.seen).empty());
    // Where no image has several, those of all views are of one.
    for (auto& people : test.seen.people)
        if (people.size() > 1) people.pop_back();
    const std::vector<motion::Person> people = motion::find_people(test.seen);
    ASSERT_EQ(people.size(), 1u);
    EXPECT_EQ(people[0].points.size(), test.seen.points.size());
}

}  // namespace
}  // namespace neuvv
