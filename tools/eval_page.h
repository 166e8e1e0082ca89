// What `neuvv eval --html` writes: one HTML file that holds its images and opens without a server or a network.
#pragma once

#include <string>
#include <vector>

#include "training/evaluate.h"

namespace neuvv::tools {

// An image of the page, kept while the evaluation goes on.
struct PageImage {
    size_t view = 0;  // index into Dataset::views
    media::Image truth, render;
};

struct PageFacts {
    std::string scene, dataset, split, device;
};

// The page: means, curves over the clip's times, tables of cameras, times and images, and `images` with
// truth, render, error and FLIP to slide over each other or to blink between; scaled down to at most kPageSide pixels.
// All names are escaped.
constexpr uint32_t kPageSide = 1280;
std::string comparison_page(const PageFacts& facts, const training::Dataset& dataset,
                            const training::Evaluation& evaluation, const std::vector<PageImage>& images);

// Text as HTML: <, >, &, " and ' as entities, control characters as spaces.
std::string html_text(const std::string& text);

}  // namespace neuvv::tools
