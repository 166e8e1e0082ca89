#include "golden/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "training/evaluation/flip.h"

namespace neuvv::test {
namespace {

GoldenDifference compare_over(const media::Image& result, const media::Image& truth, uint8_t grey) {
    const uint8_t background[3] = {grey, grey, grey};
    const media::Image a = media::composite_over(truth, background), b = media::composite_over(result, background);
    std::vector<float> errors = training::flip(a, b);
    GoldenDifference difference;
    const uint32_t width = a.width;
    difference.image = media::Image(3 * width, a.height);
    for (uint32_t y = 0; y < a.height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            std::memcpy(difference.image.at(x, y), a.at(x, y), 4);
            std::memcpy(difference.image.at(width + x, y), b.at(x, y), 4);
            uint8_t* pixel = difference.image.at(2 * width + x, y);
            std::fill_n(pixel, 3, static_cast<uint8_t>(std::lround(255 * errors[size_t{y} * width + x])));
            pixel[3] = 255;
        }
    difference.mean = training::mean_of(errors);
    std::sort(errors.begin(), errors.end());
    difference.percentile_99 = double{errors[(errors.size() - 1) * 99 / 100]};
    return difference;
}

}  // namespace

GoldenDifference compare_with_golden(const media::Image& result, const media::Image& truth) {
    if (result.width != truth.width || result.height != truth.height || result.rgba.empty()) {
        GoldenDifference difference;
        difference.same_size = false;
        difference.image = result;
        return difference;
    }
    GoldenDifference black = compare_over(result, truth, 0), white = compare_over(result, truth, 255);
    return std::max(black.mean / kGoldenMean, black.percentile_99 / kGoldenPercentile99) >=
                   std::max(white.mean / kGoldenMean, white.percentile_99 / kGoldenPercentile99)
               ? black
               : white;
}

std::string check_golden(const std::string& name, const media::Image& result, const std::filesystem::path& failures) {
    const std::filesystem::path golden = std::filesystem::path(NEUVV_GOLDEN_DIR) / (name + ".png");
    const char* accept = std::getenv("NEUVV_ACCEPT_GOLDEN");
    if (accept && (accept == name || std::strcmp(accept, "all") == 0)) {
        media::write_png(golden, result);
        return "";
    }
    const std::filesystem::path failure = failures / (name + ".png");
    std::filesystem::create_directories(failures);
    media::Image truth;
    try {
        truth = media::read_png(golden);
    } catch (const InputError& error) {
        media::write_png(failure, result);
        return fmt::format("{}; the result is {}", error.what(), failure.string());
    }
    const GoldenDifference difference = compare_with_golden(result, truth);
    if (difference.passes()) return "";
    media::write_png(failure, difference.image);
    if (!difference.same_size)
        return fmt::format("{}x{} instead of {}x{}; the result is {}", result.width, result.height, truth.width,
                           truth.height, failure.string());
    return fmt::format(
        "FLIP mean {:.4f} (at most {}), 99th percentile {:.4f} (at most {}); truth, result, difference: {}; "
        "if the result is right: tests/golden/accept {}",
        difference.mean, kGoldenMean, difference.percentile_99, kGoldenPercentile99, failure.string(), name);
}

}  // namespace neuvv::test
