#include "media/psnr.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::media {

double psnr_db(const Image& truth, const Image& result) {
    assert(truth.width == result.width && truth.height == result.height && "images to compare have one size");
    assert(truth.width > 0 && truth.height > 0 && "images to compare have pixels");
    uint64_t squared = 0;
    for (size_t i = 0; i < truth.rgba.size(); ++i) {
        const int64_t difference = i % 4 == 3 ? 0 : int64_t{truth.rgba[i]} - int64_t{result.rgba[i]};
        squared += static_cast<uint64_t>(difference * difference);
    }
    const double error = static_cast<double>(squared) / (3.0 * truth.width * truth.height * 255 * 255);
    return error > 0 ? std::min(kMaxPsnr_db, -10 * std::log10(error)) : kMaxPsnr_db;
}

}  // namespace neuvv::media
