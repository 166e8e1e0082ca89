// Boxes around splats: of all of them, and of nearly all, without those that float far away.
#pragma once

#include <optional>
#include <string>

#include "interchange/splats/splats.h"

namespace neuvv::interchange {

struct SplatBox {
    glm::dvec3 low{0}, high{0};  // metres
    double longest_m() const;
};
// A box around two deviations of all splats that can be seen; empty where there are none.
SplatBox box_of(const Splats& splats);

// The box of a clip. Trained scenes have floaters: a few splats that are many times farther away than all others, or
// larger. Cells of a box around them would be larger than what is to be seen.
struct MainBox {
    // Around all splats but those that reach beyond the box of the middle 96 % of them, made five times as large.
    SplatBox box;
    size_t beyond = 0;                // how many splats reach beyond it
    const Splat* farthest = nullptr;  // of these, where there are any
    // Around the middle 80 % of splats, where that is less than a quarter as large as `box`.
    std::optional<SplatBox> dense;
};
MainBox main_box_of(const Splats& splats);

// Removes the splats that do not reach into the box.
void crop(Splats& splats, const SplatBox& box);

// "splat 12 at (1, 2, 3)", with its row in the file.
std::string place_of(const Splat& splat);
// "-1,0,-1,1,2,1": from the low corner to the high one.
std::string text_of(const SplatBox& box);

}  // namespace neuvv::interchange
