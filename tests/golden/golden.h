// Comparing an image with its golden one.
#pragma once

#include <filesystem>
#include <string>

#include "media/image.h"

namespace neuvv::test {

// An image is right when LDR-FLIP against its golden one stays below both. One step of 8 bits in every pixel, which
// devices may round differently, is about 0.03.
constexpr double kGoldenMean = 0.01;
constexpr double kGoldenPercentile99 = 0.05;

struct GoldenDifference {
    bool same_size = true;
    double mean = 0, percentile_99 = 0;
    media::Image image;  // truth | result | FLIP as grey

    bool passes() const { return same_size && mean <= kGoldenMean && percentile_99 <= kGoldenPercentile99; }
};

// Both over black and over white, so that alpha counts; the worse one is reported.
GoldenDifference compare_with_golden(const media::Image& result, const media::Image& truth);

// Compares with NEUVV_GOLDEN_DIR/NAME.png. On a failure writes the side by side image as failures/NAME.png and
// returns what is wrong and where to look, else an empty string. With NEUVV_ACCEPT_GOLDEN=NAME (or all) in the
// environment the result becomes the golden image.
std::string check_golden(const std::string& name, const media::Image& result,
                         const std::filesystem::path& failures = NEUVV_GOLDEN_FAILURES);

}  // namespace neuvv::test
