// The page that `neuvv eval --html` writes: whole, self-contained, and safe with hostile names.
#include "tools/eval/eval_page.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "tools/html.h"

namespace neuvv {
namespace {

size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

struct EvalPage : testing::Test {
    training::Dataset dataset = test::sphere_dataset({.cameras = 3, .frames = 4, .size = 20});
    training::Evaluation evaluation;

    void SetUp() override {
        evaluation.cameras.resize(3);
        evaluation.frames.resize(4);
        for (size_t i = 0; i < dataset.views.size(); ++i) {
            const training::Quality quality{
                .psnr = 30.0 + static_cast<double>(i), .ssim = 0.9, .mae = 0.01, .flip = 0.05};
            evaluation.views.push_back(quality);
            evaluation.cameras[i / 4] = {quality, 4};
            evaluation.frames[i % 4] = {quality, 3};
        }
        evaluation.mean = {.psnr = 35.25, .ssim = 0.9, .mae = 0.01, .flip = 0.05};
    }
    std::string page(const std::vector<size_t>& views) const {
        std::vector<tools::PageImage> images;
        for (const size_t view : views) {
            const media::Image truth = training::truth_over(dataset, dataset.views[view]);
            media::Image render = truth;
            render.at(3, 3)[1] = 0;
            images.push_back({view, truth, render});
        }
        return tools::comparison_page({"a.nvv", "data", "test", "llvmpipe"}, dataset, evaluation, images);
    }
};

TEST_F(EvalPage, HoldsImagesNumbersAndCurves) {
    const std::string html = page({1, 7});
    EXPECT_EQ(html.find("<!DOCTYPE html>"), 0u);
    EXPECT_EQ(count_of(html, "<figure"), 2u);
    EXPECT_EQ(count_of(html, "src=\"data:image/png;base64,"), 8u);
    EXPECT_EQ(count_of(html, "<option>c00_f001 (31.00 dB)"), 1u);
    EXPECT_NE(html.find("PSNR 35.25 dB"), std::string::npos);
    EXPECT_EQ(count_of(html, "<polyline"), 4u);
    EXPECT_EQ(count_of(html, "<tr><td>"), 3u + 4u + 12u);
    for (const char* element : {"table", "figure", "svg", "select", "section", "script", "style", "div", "tr", "td"})
        EXPECT_EQ(count_of(html, std::string("<") + element + " ") + count_of(html, std::string("<") + element + ">"),
                  count_of(html, std::string("</") + element + ">"))
            << element;
}

TEST_F(EvalPage, NeedsNoNetwork) {
    const std::string html = page({0});
    for (const char* reference : {"http://", "https://", "url(", "<link", "@import", "fetch("})
        EXPECT_EQ(html.find(reference), std::string::npos) << reference;
    EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST_F(EvalPage, ImagesSurviveTheirEncoding) {
    const std::string html = page({0}), head = "alt=\"truth\" src=\"data:image/png;base64,";
    const size_t begin = html.find(head) + head.size(), end = html.find('"', begin);
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<uint8_t> bytes;
    uint32_t bits = 0, filled = 0;
    for (size_t i = begin; i < end && html[i] != '='; ++i) {
        bits = bits << 6 | static_cast<uint32_t>(digits.find(html[i]));
        filled += 6;
        if (filled < 8) continue;
        filled -= 8;
        bytes.push_back(static_cast<uint8_t>(bits >> filled));
    }
    EXPECT_EQ((end - begin) % 4, 0u);
    EXPECT_EQ(media::decode_image(bytes.data(), bytes.size(), "truth").rgba,
              training::truth_over(dataset, dataset.views[0]).rgba);
}

TEST_F(EvalPage, HostileNamesStayText) {
    dataset.views[0].name = "<script>alert(1)</script>";
    dataset.views[5].name = "\"><img src=x onerror='alert(1)'>\n";
    const std::string html = page({0, 5});
    EXPECT_EQ(count_of(html, "<script>"), 1u) << "the page's own";
    EXPECT_EQ(html.find("<img src=x"), std::string::npos);
    EXPECT_NE(html.find("&lt;script&gt;alert(1)&lt;/script&gt;"), std::string::npos);
    EXPECT_EQ(tools::html_text("a&b<c>\"'\x01"), "a&amp;b&lt;c&gt;&quot;&#39; ");
}

TEST_F(EvalPage, LargeImagesAreShrunk) {
    test::Random random(5);
    media::Image noise(4000, 20);  // cannot be compressed, so that the size of the page shows how large the image is
    for (uint8_t& byte : noise.rgba) byte = static_cast<uint8_t>(random.below(256));
    const std::string html = tools::comparison_page({}, dataset, evaluation, {{0, noise, noise}});
    EXPECT_LT(html.size(), noise.rgba.size() / 2);
    EXPECT_GT(html.size(), noise.rgba.size() / 16);
}

TEST(CameraLabels, AreWhatTheNamesBeginWith) {
    training::Dataset dataset = test::sphere_dataset({.cameras = 3, .frames = 4, .size = 2});
    EXPECT_EQ(training::camera_labels(dataset), (std::vector<std::string>{"c00", "c01", "c02"}));
    for (training::View& view : dataset.views)
        view.name = "r_" + view.name.substr(5);  // all alike: cameras get their numbers
    EXPECT_EQ(training::camera_labels(dataset), (std::vector<std::string>{"0", "1", "2"}));
    dataset.views.resize(1);
    dataset.views[0].name = "only_one";
    EXPECT_EQ(training::camera_labels(dataset), (std::vector<std::string>{"0", "1", "2"}))
        << "two cameras have no image";
    dataset.cameras.resize(1);
    EXPECT_EQ(training::camera_labels(dataset), (std::vector<std::string>{"only_one"}));
}

TEST(SpreadViews, CoversCamerasAndInstants) {
    const training::Dataset dataset = test::sphere_dataset({.cameras = 4, .frames = 6, .size = 2});
    EXPECT_EQ(training::spread_views(dataset, 100).size(), 24u);
    const std::vector<size_t> views = training::spread_views(dataset, 8);
    EXPECT_EQ(views.size(), 8u);
    EXPECT_TRUE(std::is_sorted(views.begin(), views.end()));
    std::set<uint32_t> cameras;
    std::set<size_t> frames;
    for (const size_t view : views) {
        cameras.insert(dataset.views[view].camera);
        frames.insert(training::frame_of_view(dataset, dataset.views[view]));
    }
    EXPECT_EQ(cameras.size(), 4u);
    EXPECT_GE(frames.size(), 5u);
    EXPECT_EQ(training::spread_views(dataset, 1).size(), 1u);
}

}  // namespace
}  // namespace neuvv
