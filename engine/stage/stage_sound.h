// The sound of a stage, as videos of it have it: what its performers' sounds are together.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "stage/heard.h"
#include "stage/stage.h"

namespace neuvv::stage {

class StageSound {
  public:
    // Whether a performer is heard at all, by its index into Stage::performers.
    using IsHeard = std::function<bool(uint32_t performer)>;

    // Reads the sounds of the performers that are visible at the stage time at which it begins, each file once. Without
    // `is_heard`, all of them are heard. Throws InputError.
    StageSound(const Stage& stage, double begin_s, const IsHeard& is_heard = {});

    bool is_silent() const { return heard_.empty(); }
    // The next samples; where it is louder than a file can be, it is cut off there.
    void next(std::array<media::StereoSample, media::kSoundHop>& samples);

  private:
    struct OfPerformer {
        std::shared_ptr<const media::Sound> sound;
        Heard heard;
        float gain;
    };
    std::vector<OfPerformer> heard_;
};

}  // namespace neuvv::stage
