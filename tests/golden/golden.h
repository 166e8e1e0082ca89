// The comparison of an image with its golden image.
#pragma once

#include <filesystem>
#include <string>

#include "media/image.h"

namespace neuvv::test {

// An image is right when LDR-FLIP against its golden image exceeds neither of these, in the mean and in the 99th
// percentile. One step of 8 bits in a pixel, as devices may round differently, is about 0.03.
constexpr double kGoldenMean = 0.01;
constexpr double kGoldenPercentile99 = 0.05;

struct GoldenDifference {
    bool same_size = true;
    double mean = 0, percentile_99 = 0;
    media::Image image;  // truth | result | FLIP as grey

    bool passes() const { return same_size && mean <= kGoldenMean && percentile_99 <= kGoldenPercentile99; }
};

// Compares both over black and over white, so that alpha counts, and returns the worse result.
GoldenDifference compare_with_golden(const media::Image& result, const media::Image& truth);

// Compares the result with NEUVV_GOLDEN_DIR/NAME.png and returns an empty string where it is right. Otherwise it writes
// truth, result and difference side by side as failures/NAME.png, and returns a message. With NEUVV_ACCEPT_GOLDEN=NAME
// (or all) in the environment, the result becomes the golden image.
std::string check_golden(const std::string& name, const media::Image& result,
                         const std::filesystem::path& failures = NEUVV_GOLDEN_FAILURES);

}  // namespace neuvv::test
