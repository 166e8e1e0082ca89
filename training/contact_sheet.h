// Many images on one, for looking at.
#pragma once

#include <vector>

#include "media/image.h"

namespace neuvv::training {

// The image on white by a whole factor, so that its longest side is as near `longest` as such a factor allows, and
// not above: smaller by block means, larger by repeated pixels.
media::Image scaled_to_fit(const media::Image& image, uint32_t longest);

// Images in a grid of cells of `cell` × `cell` pixels, each scaled to fit and centred, on white.
media::Image contact_sheet(const std::vector<media::Image>& images, uint32_t columns, uint32_t cell);

}  // namespace neuvv::training
