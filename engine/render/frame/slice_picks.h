// Slice picks: picks in slices on the device that are under way between two images, and their results.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "render/volume/performer.h"

namespace neuvv::render {

// Has the device pick after the images that are under way, and keeps the results in order. The slices that begun picks
// read, and their performers, must exist until finish().
class SlicePicks {
  public:
    // Picks in a built slice of a performer (SlicePicker::begin).
    void begin(Performer& performer, uint32_t slice, std::span<const PickRay> rays, float alpha) {
        SlicePicker& picker = performer.idle_picker();
        picker.begin(slice, rays, alpha);
        picking_.push_back(&picker);
    }
    // Waits for the picks, but for no image that was submitted after them.
    void finish() {
        for (SlicePicker* picker : std::exchange(picking_, {})) picked_.push_back(picker->take());
    }
    // The results since the last take(), in the order of begin().
    std::vector<std::vector<Picked>> take() {
        finish();
        return std::exchange(picked_, {});
    }
    // Takes over what another one, which is finished, has not given away.
    void take_over(SlicePicks& other) { picked_ = std::move(other.picked_); }

  private:
    std::vector<SlicePicker*> picking_;        // begun, not finished
    std::vector<std::vector<Picked>> picked_;  // until take()
};

}  // namespace neuvv::render
