// Mattes and masks as images: what their values are, and how they are written.
#pragma once

#include <algorithm>

#include "media/image.h"

namespace neuvv::training {

inline bool is_opaque(const media::Image& image) {
    for (size_t i = 3; i < image.rgba.size(); i += 4)
        if (image.rgba[i] != 255) return false;
    return true;
}

// The values of a matte or a mask: its alpha where it has one, else the brightest of R, G and B.
class MaskValues {
  public:
    // The image must outlive the object.
    explicit MaskValues(const media::Image& mask) : mask_(mask), by_alpha_(!is_opaque(mask)) {}
    uint8_t operator[](size_t pixel) const {
        const uint8_t* at = &mask_.rgba[4 * pixel];
        return by_alpha_ ? at[3] : std::max({at[0], at[1], at[2]});
    }

  private:
    const media::Image& mask_;
    const bool by_alpha_;
};

// A grey image of the size of `like`, with value(pixel) from 0 to 255.
template <typename Value>
media::Image grey_image(const media::Image& like, const Value& value) {
    media::Image grey(like.width, like.height);
    for (size_t i = 0; i < grey.rgba.size() / 4; ++i) {
        std::fill_n(&grey.rgba[4 * i], 3, static_cast<uint8_t>(value(i)));
        grey.rgba[4 * i + 3] = 255;
    }
    return grey;
}

}  // namespace neuvv::training
