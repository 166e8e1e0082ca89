// The sound of a stage, as videos of it have it: what a camera hears of its performers' sounds together, each from
// where its performer is (pan.h).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "stage/evaluated_stage.h"
#include "stage/sound/heard.h"
#include "stage/stage.h"

namespace neuvv::stage {

class StageSound {
  public:
    // Whether a performer is heard at all, by its index into Stage::performers.
    using IsHeard = std::function<bool(uint32_t performer)>;
    // Where the ear is at the time of `evaluated`: its axes are those of Camera::world_from_camera.
    using EarAt = std::function<glm::dmat4(const EvaluatedStage& evaluated)>;

    // Reads the sounds of the performers that are visible at the stage time at which it begins, each file once, and
    // those of servers from there. Without `is_heard`, all of them are heard. The stage must outlive it. Throws
    // InputError, what `ear_at` throws, and where it waits for a server soon after `stop` was requested.
    StageSound(const Stage& stage, double begin_s, EarAt ear_at, const IsHeard& is_heard = {},
               const std::stop_token& stop = {});

    bool is_silent() const { return heard_.empty(); }
    // The next samples; where it is louder than a file can be, it is cut off there. Both sides of a performer's sound
    // are one. Ear and performers are looked for at the end of these samples, and until then gains change evenly, so
    // that nothing clicks. Throws what `ear_at` throws.
    void next(std::array<media::StereoSample, media::kSoundHop>& samples);

  private:
    using Gains = std::array<float, 2>;  // left and right
    struct OfPerformer {
        uint32_t performer;
        std::shared_ptr<const media::Sound> sound;
        Heard heard;
        float own_gain;
        Gains gains;  // at the end of the samples that were made
    };
    static Gains gains_of(const OfPerformer& one, const EvaluatedStage& evaluated, const glm::dmat4& world_from_ear);

    const Stage& stage_;
    double begin_s_;
    EarAt ear_at_;
    uint64_t hops_ = 0;  // that were made
    std::vector<OfPerformer> heard_;
};

}  // namespace neuvv::stage
