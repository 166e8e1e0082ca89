// Intervals of rays on the host and the layers that are made of them, against brute force.
#include "render/frame/image_layers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/merge.h"
#include "render/rays/linear_image.h"
#include "render/rays/ray_intervals.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/traced.h"

namespace neuvv::test::image_layers_test {
namespace {

constexpr uint32_t kWidth = 53, kHeight = 38;
const std::vector<std::string> kNames = {"anna", "berta", "carla", "anna"};  // two of one name are one

using ImageLayersTest = GpuTest;

// Three instances that stand in each other, one of them translucent, and one behind them.
std::vector<render::Instance> a_crowd() {
    std::vector<render::Instance> crowd = {
        {1.3f, glm::mat4(1), 0, 0, 1},
        {0.0f, placed({0.4f, 0.2f, -0.3f}, 0.7f, glm::vec3(1.2f, 0.8f, 1)), 0, 0, 1},
        {2.0f, placed({-0.5f, 0.1f, 0.2f}, -1.1f, glm::vec3(-0.9f, 0.9f, 1.1f)), 0, 0, 0.6f, 0.7f},
        {0.5f, placed({-1, 0.3f, -5}, 2, glm::vec3(2)), 0, 0, 1, 1.5f}};
    for (uint32_t i = 0; i < crowd.size(); ++i) crowd[i].performer = i;
    return crowd;
}

voctree::VOctree a_tree() {
    return random_tree({.seed = 3, .node_levels = 3, .leaves = 1500, .bases = 5, .hh_degree = 1});
}

stage::Camera a_camera() {
    return look_at({0.9, 1.2, 4.5}, {0, 0.4, 0}, kWidth, kHeight, 0.9);
}

render::FrameSettings settings_of(uint32_t samples) {
    render::FrameSettings settings;
    settings.instances = a_crowd();
    settings.width = kWidth;
    settings.height = kHeight;
    settings.samples = samples;
    settings.stop = 0;
    return settings;
}

// The samples of each instance along a ray, in the world.
class Truth {
  public:
    explicit Truth(const voctree::VOctree& tree) : tree_(tree) {
        for (const render::Instance& instance : a_crowd())
            slices_.push_back(reference::slice_tree(tree, double{instance.frame}));
    }
    std::vector<std::vector<reference::Sample>> samples(const reference::Ray& ray) const {
        std::vector<std::vector<reference::Sample>> all;
        const std::vector<render::Instance> crowd = a_crowd();
        for (size_t i = 0; i < crowd.size(); ++i) {
            const glm::dmat4 performer_from_world = glm::inverse(glm::dmat4(crowd[i].world_from_performer));
            reference::Ray own = ray;
            own.origin = glm::dvec3(performer_from_world * glm::dvec4(ray.origin, 1));
            const glm::dvec3 direction = glm::dmat3(performer_from_world) * ray.direction;
            own.direction = glm::normalize(direction);
            all.push_back(reference::in_world(reference::ray_samples(tree_, slices_[i], own),
                                              1 / glm::length(direction), double{crowd[i].opacity},
                                              double{crowd[i].density}));
        }
        return all;
    }

  private:
    const voctree::VOctree& tree_;
    std::vector<std::vector<reference::LeafSlice>> slices_;
};

// How much of the ray's end each performer is: what is white where the others are black.
std::vector<double> shares_of(std::vector<std::vector<reference::Sample>> samples) {
    std::vector<double> shares;
    for (size_t white = 0; white < samples.size(); ++white) {
        for (size_t i = 0; i < samples.size(); ++i)
            for (reference::Sample& sample : samples[i]) sample.colour = glm::dvec3(i == white ? 1 : 0);
        shares.push_back(reference::composite(reference::merge(samples)).colour.r);
    }
    return shares;
}

// The transmittance of merged samples, up to `m` metres along the ray.
double transmittance(const std::vector<reference::Sample>& samples, double m) {
    double depth = 0;
    for (const reference::Sample& sample : samples) {
        const double begin = sample.z_m - sample.delta_m / 2;
        depth += sample.sigma * std::clamp(m - begin, 0.0, sample.delta_m);
    }
    return std::exp(-depth);
}

glm::dvec4 composited(std::span<const media::DeepSample> samples) {
    glm::dvec4 sum(0);
    for (const media::DeepSample& sample : samples) {
        const double through = 1 - sum.a;
        for (int c = 0; c < 4; ++c) sum[c] += through * double{sample.rgba[static_cast<size_t>(c)]};
    }
    return sum;
}

// The transmittance of a pixel's samples up to a depth, as programs cut deep samples.
double transmittance(std::span<const media::DeepSample> samples, double m) {
    double through = 1;
    for (const media::DeepSample& sample : samples) {
        const double near = double{sample.near_m}, far = double{sample.far_m};
        const double part = far > near ? std::clamp((m - near) / (far - near), 0.0, 1.0) : (m > near ? 1.0 : 0.0);
        through *= std::pow(1 - double{sample.rgba[3]}, part);
    }
    return through;
}

struct Drawn {
    media::LinearImage flat;
    render::ImageLayers layers;
};

Drawn draw(const gpu::Device& device, const voctree::VOctree& tree, uint32_t samples, const render::SetRays& set) {
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, {kWidth, kHeight, samples});
    const render::FrameSettings settings = settings_of(samples);
    renderer.render(a_camera(), settings);
    const media::LinearImage flat = render::linear_image(renderer.radiance(), renderer.depth(), a_camera(), samples);
    render::ImageLayers layers(a_camera(), samples, kNames, set, {true, true}, settings.stop);
    renderer.read_intervals([&](glm::uvec2 ray, auto intervals) { layers.add(ray, intervals); });
    layers.finish();
    renderer.render(a_camera(), settings);
    EXPECT_EQ(render::linear_image(renderer.radiance(), renderer.depth(), a_camera(), samples).rgba, flat.rgba)
        << "images are drawn as before";
    return {flat, layers};
}

double coverage_of(const render::ImageLayers& layers, size_t pixel, const std::string& name) {
    for (const media::IdRank& rank : layers.ids.pixels[pixel])
        if (rank.coverage > 0 && layers.ids.names[rank.name] == name) return double{rank.coverage};
    return 0;
}

TEST_F(ImageLayersTest, OneRayAPixelIsTheReference) {
    const voctree::VOctree tree = a_tree();
    const Drawn drawn = draw(device(), tree, 1, {});
    const Truth truth(tree);
    EXPECT_EQ(drawn.layers.ids.names, (std::vector<std::string>{"anna", "berta", "carla"}));
    double worst_share = 0, worst_depth = 0, worst_cut = 0, seen = 0;
    auto at = drawn.layers.deep.samples.begin();
    for (size_t i = 0; i < drawn.layers.deep.counts.size(); ++i) {
        const std::span samples(at, drawn.layers.deep.counts[i]);
        at += drawn.layers.deep.counts[i];
        const auto ray =
            reference::camera_ray(a_camera(), static_cast<double>(i % kWidth), static_cast<double>(i / kWidth));
        const auto all = truth.samples(ray);
        const std::vector<double> shares = shares_of(all);
        const auto merged = reference::merge(all);
        const double axis = -glm::dot(ray.direction, glm::dvec3(a_camera().world_from_camera[2]));
        raise(worst_share, std::abs(coverage_of(drawn.layers, i, "anna") - shares[0] - shares[3]));
        raise(worst_share, std::abs(coverage_of(drawn.layers, i, "berta") - shares[1]));
        raise(worst_share, std::abs(coverage_of(drawn.layers, i, "carla") - shares[2]));
        const reference::RayResult whole = reference::composite(merged);
        seen += whole.alpha / (kWidth * kHeight);
        if (whole.alpha > 0.01) raise(worst_depth, std::abs(double{drawn.flat.depth_m[i]} - axis * whole.depth_m));
        EXPECT_LE(samples.size(), render::kDeepSamples);
        for (double m = 2; samples.size() < render::kDeepSamples && m < 13; m += 0.37)
            raise(worst_cut, std::abs(transmittance(samples, axis * m) - transmittance(merged, m)));
    }
    EXPECT_GT(seen, 0.1);
    EXPECT_LE(worst_share, 1.0 / 512) << "optical depths are fp16";
    EXPECT_LE(worst_depth, 10 * kDepth_m) << "11 m away, densities as fp16";
    EXPECT_LE(worst_cut, double{render::kDeepError} + 1.0 / 512);
}

TEST_F(ImageLayersTest, DeepSamplesAreTheFlatImage) {
    const voctree::VOctree tree = a_tree();
    for (const uint32_t samples : {2u, 3u}) {  // of 3, a pixel's rays lie in several tiles
        const Drawn drawn = draw(device(), tree, samples, {});
        double worst = 0, worst_sum = 0;
        size_t most = 0;
        auto at = drawn.layers.deep.samples.begin();
        for (size_t i = 0; i < drawn.layers.deep.counts.size(); ++i) {
            const glm::dvec4 sum = composited({at, drawn.layers.deep.counts[i]});
            at += drawn.layers.deep.counts[i];
            most = std::max<size_t>(most, drawn.layers.deep.counts[i]);
            for (int c = 0; c < 4; ++c)
                raise(worst, std::abs(sum[c] - double{drawn.flat.rgba[4 * i + static_cast<size_t>(c)]}));
            double covered = 0;
            for (const char* name : {"anna", "berta", "carla"}) covered += coverage_of(drawn.layers, i, name);
            raise(worst_sum, std::abs(covered - double{drawn.flat.rgba[4 * i + 3]}));
        }
        EXPECT_LE(worst, 1.0 / 1024) << "intervals are fp16";
        EXPECT_LE(worst_sum, 1.0 / 1024);
        EXPECT_EQ(most, render::kDeepSamples) << "the limit is reached, and light and alpha are right all the same";
    }
}

// A wall behind all performers that lets a quarter through; before one of its pixels something is blended.
TEST_F(ImageLayersTest, TheSetIsASurfaceWithAName) {
    render::SetRays set;
    set.behind.assign(kWidth * kHeight, {0.3f, 0.2f, 0.1f, 0.75f});
    set.front.assign(kWidth * kHeight, glm::vec4(0));
    set.axis_m.assign(kWidth * kHeight, 20);
    set.axis_m[0] = INFINITY;
    set.front[1] = {0.1f, 0.1f, 0.1f, 0.5f};
    const Drawn drawn = draw(device(), a_tree(), 1, set);
    size_t clear = 0;
    auto at = drawn.layers.deep.samples.begin();
    for (size_t i = 0; i < drawn.layers.deep.counts.size(); ++i) {
        const std::span samples(at, drawn.layers.deep.counts[i]);
        at += drawn.layers.deep.counts[i];
        const double alpha = double{drawn.flat.rgba[4 * i + 3]}, covered = coverage_of(drawn.layers, i, "set");
        if (i == 0) {
            EXPECT_EQ(alpha + covered, 0) << "the first pixel shows nothing";
            continue;
        }
        EXPECT_NEAR(covered, i == 1 ? 0.5 + 0.5 * 0.75 : 0.75 * (1 - alpha), 1.0 / 1024) << i;
        ASSERT_FALSE(samples.empty());
        EXPECT_NEAR(composited(samples).r, double{drawn.flat.rgba[4 * i]} + 0.3 * (1 - alpha), 1.0 / 1024) << i;
        if (samples.size() == render::kDeepSamples || 1 - alpha < 4 * double{render::kDeepError}) continue;
        ++clear;
        EXPECT_EQ(samples.back().near_m, 20) << i;
        EXPECT_EQ(samples.back().far_m, 20) << i;
        EXPECT_NEAR(samples.back().rgba[3], 0.75, 1e-3) << i;
    }
    EXPECT_GT(clear, drawn.layers.deep.counts.size() / 2);
}

TEST(ImageLayers, NoPerformerSharesTheNameOfTheSet) {
    render::SetRays set;
    set.behind.assign(kWidth * kHeight, glm::vec4(0));
    set.front = set.behind;
    set.axis_m.assign(kWidth * kHeight, 20);
    const std::vector<std::string> performers = {"set", "anna", "set_", "anna"};
    const render::ImageLayers layers(a_camera(), 1, performers, set, {true, false}, 0);
    EXPECT_EQ(layers.ids.names, (std::vector<std::string>{"set", "anna", "set_", "set__"}));
}

TEST(DeepPixel, SurfacesAndGapsStaySharp) {
    const std::vector<std::vector<render::RayStretch>> rays = {
        {{1, 2, 1, 0.5f, glm::vec3(0.25f)}, {4, 4, 0.5f, 0, glm::vec3(0.1f)}}, {}};
    const std::vector<media::DeepSample> samples = render::deep_samples(rays);
    ASSERT_GE(samples.size(), 2u);
    EXPECT_EQ(samples.front().near_m, 1);
    EXPECT_EQ(samples[samples.size() - 2].far_m, 2) << "nothing is between the two";
    EXPECT_EQ(samples.back().near_m, 4);
    EXPECT_EQ(samples.back().far_m, 4);
    EXPECT_NEAR(composited(samples).a, 0.5, 1e-6);
    EXPECT_NEAR(composited(samples).r, 0.5 * 0.35, 1e-6);
    EXPECT_NEAR(transmittance(samples, 1.5), 0.5 + 0.5 * std::sqrt(0.5), double{render::kDeepError});
    EXPECT_EQ(render::deep_samples(rays, 2).size(), 2u);
    EXPECT_TRUE(render::deep_samples(std::vector<std::vector<render::RayStretch>>(4)).empty());
}

// Too thin for a float to tell, and behind what lets nothing through.
TEST(DeepPixel, WhatTakesNoLightIsNoStretch) {
    const auto interval = [](float near_m, float far_m, float optical_depth) {
        render::RayInterval one;
        one.near_m = near_m;
        one.far_m = far_m;
        one.optical_depth = optical_depth;
        one.colour = glm::vec3(1);
        return one;
    };
    const std::vector<render::RayInterval> thin = {interval(1, 3, 1e-9f), interval(4, 5, 200), interval(6, 8, 1)};
    const std::vector<render::RayInterval> plain = {interval(2, 2.5f, 1), interval(7, 7.5f, 1)};
    const std::vector<std::vector<render::RayStretch>> rays = {render::merge_intervals(thin, 0).stretches,
                                                               render::merge_intervals(plain, 0).stretches};
    ASSERT_EQ(rays[0].size(), 1u);
    const std::vector<media::DeepSample> samples = render::deep_samples(rays);
    ASSERT_FALSE(samples.empty());
    for (const media::DeepSample& sample : samples)
        for (const float value : sample.rgba) EXPECT_TRUE(std::isfinite(value)) << sample.near_m;
}

}  // namespace
}  // namespace neuvv::test::image_layers_test
