// The page of `neuvv eval --html`: one HTML file that contains its images, and opens without a server or a network.
#pragma once

#include <string>
#include <vector>

#include "training/evaluation/evaluate.h"

namespace neuvv::tools {

// An image of the page.
struct PageImage {
    size_t view = 0;  // index into Dataset::views
    media::Image truth, render;
};

// What the page says it compares, and the device that rendered.
struct PageFacts {
    std::string scene, dataset, split, device;
    std::string compared = "over white";  // what of the images, and over what
    std::string note = {};                // a line under the heading; empty: none
};

// The page has means, curves over the clip's frames, and tables of cameras, frames and images. Truth, render, error and
// FLIP of each of `images` slide over each other or blink. All names are escaped.
constexpr uint32_t kMaxPageSide = 1280;  // pixels a side of an image; larger ones are scaled down
std::string comparison_page(const PageFacts& facts, const training::Dataset& dataset,
                            const training::Evaluation& evaluation, const std::vector<PageImage>& images);

}  // namespace neuvv::tools
