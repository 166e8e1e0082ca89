// How far two images of the same size are apart.
#pragma once

#include <cstdlib>

#include "media/image.h"

namespace neuvv {

// The mean difference of their bytes.
inline double distance(const media::Image& a, const media::Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) sum += std::abs(int{a.rgba[i]} - int{b.rgba[i]});
    return sum / static_cast<double>(a.rgba.size());
}

}  // namespace neuvv
