// The sound of a stage: what its performers' sounds are together.
#pragma once

#include <memory>
#include <vector>

#include "stage/heard.h"
#include "stage/stage.h"

namespace neuvv::tools {

class StageSound {
  public:
    // Reads the sounds of the performers that are visible at the stage time at which it begins, each file once. Throws
    // InputError.
    StageSound(const stage::Stage& stage, double begin_s);

    bool is_silent() const { return heard_.empty(); }
    // The next samples; where it is louder than a file can be, it is cut off there.
    void next(std::array<media::StereoSample, media::kSoundHop>& samples);

  private:
    struct OfPerformer {
        std::shared_ptr<const media::Sound> sound;
        stage::Heard heard;
        float gain;
    };
    std::vector<OfPerformer> heard_;
};

}  // namespace neuvv::tools
