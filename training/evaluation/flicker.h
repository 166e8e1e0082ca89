// Flicker: how much a render changes from one frame to the next in other ways than the truth does. A clip in segments
// should not flicker more at its cuts than elsewhere.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "media/image.h"

namespace neuvv::training {

// Mean absolute differences of the encoded values, in steps of 255, over the pixels of the performer: where the truth
// does not change from the one frame to the next, and where it does.
struct FlickerLevels {
    double still = 0, moving = 0;
};

class FlickerMeter {
  public:
    // `background`: RGB behind the images.
    FlickerMeter(size_t cameras, size_t frames, const uint8_t* background = media::kWhite)
        : background_(background), last_(cameras), steps_(frames > 0 ? frames - 1 : 0) {}

    // Adds both images of a view. Two views of a camera are compared where the second is of the frame that
    // follows on that of the first, and nothing of this camera comes in between.
    void add(size_t camera, size_t frame, const media::Image& truth, const media::Image& render);

    // The step from frame i to frame i + 1, over all cameras; nothing where it was seen nowhere.
    std::optional<FlickerLevels> step(size_t i) const;

    struct Summary {
        FlickerLevels cuts, others;  // medians over the steps
        size_t cut_count = 0;        // of the cuts that were seen
    };
    // `cuts`: the steps, ascending, over which a segment gives way to the next. Nothing where no other step was seen.
    std::optional<Summary> summary(const std::vector<size_t>& cuts) const;

  private:
    struct Shown {
        size_t frame;
        media::Image truth, render;
    };
    struct Sums {
        double still = 0, moving = 0;
        uint64_t still_values = 0, moving_values = 0;
    };
    const uint8_t* background_;
    std::vector<std::optional<Shown>> last_;  // by camera
    std::vector<Sums> steps_;
};

}  // namespace neuvv::training
