// What is heard of a performer's sound as its clip plays by a time map: at the clip's own pitch however fast it plays,
// backwards where it plays backwards, and nothing while it stands still.
#pragma once

#include "media/sound.h"
#include "stage/time_map.h"

namespace neuvv::stage {

constexpr double kLeastHeardSpeed = 1e-3;  // of the recording's; below, the clip stands still and nothing is heard
constexpr double kMostHeardSpeed = 100;    // above, the clip jumps

// The sound begins with the clip. It is cut into grains of two hops that fade into each other, each taken where the
// clip is at the grain's centre (overlap-add; Verhelst and Roelands 1993). Where the clip plays as it was recorded,
// grains follow each other, and what is heard is the sound as it is, sample by sample. Where it is faster or slower, a
// grain is moved by up to half a hop to where it goes on like the one before.
class Heard {
  public:
    // From a stage time on, where the stage's clock runs at `speed` stage seconds a second, backwards below 0. The
    // sound must outlive it.
    Heard(const media::Sound& sound, Timeline timeline, double begin_s, double speed = 1);

    // To be called before the first hop, which then rises from silence.
    void begin_softly() { before_ = {}; }

    // Adds the next hop, times `gain`.
    void add_hop(std::array<media::StereoSample, media::kSoundHop>& samples, float gain);

  private:
    struct Grain {
        int64_t first = 0;  // sample of the sound
        int step = 0;       // 1, −1 backwards, 0: silent
    };
    Grain grain_at(double heard_s) const;
    // Moves the grain to where it goes on like the one before.
    Grain aligned(Grain grain) const;
    media::StereoSample sample(const Grain& grain, size_t at) const;
    double likeness(const Grain& a, const Grain& b) const;

    const media::Sound& sound_;
    Timeline timeline_;
    double begin_s_, speed_;
    uint64_t hops_ = 0;  // that were made
    Grain before_;       // fades out during the next hop
};

}  // namespace neuvv::stage
