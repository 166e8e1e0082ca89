// Many images in one, for people to look at.
#pragma once

#include <vector>

#include "media/image.h"

namespace neuvv::training {

// The image over white, scaled by a whole factor or divided by one, so that its longest side comes as near to `longest`
// pixels as that allows without exceeding it. Smaller images are means of blocks, larger ones repeat pixels.
media::Image scaled_to_fit(const media::Image& image, uint32_t longest);

// Images over white in a grid, row by row, each scaled to fit `longest` pixels a side and centred in its cell. Cells
// are as wide as the widest of them then is, and as high as the highest.
media::Image contact_sheet(const std::vector<media::Image>& images, uint32_t columns, uint32_t longest);

}  // namespace neuvv::training
