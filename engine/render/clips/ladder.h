// The ladder: how many parts of its frames a player takes, so that they are there in time. A stream has all of its
// rates in one file, as every prefix of a group's parts draws.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stream/codec/frame_cost.h"

namespace neuvv::render {

// What is done for each frame besides decoding its planes. It takes the same time whichever parts are decoded.
enum class FrameStep { kShape, kUpload, kCount };

// Learns how long frames take until they can be drawn, and chooses by that and by how fast bytes come. It takes all
// frames for independent, but those of a key frame are decoded one after the other.
class Ladder {
  public:
    // `frames_at_once`: how many frames are decoded and made ready at the same time.
    explicit Ladder(uint32_t frames_at_once) : frames_at_once_(frames_at_once) {}
    // The planes of a frame's parts of so many bytes were decoded in so many seconds.
    void learn_planes(uint64_t bytes, double seconds);
    void learn_step(FrameStep step, double seconds);
    // The last part up to which the frames come at their rate, at least kCoarse. `bytes_per_s`: as they come from a
    // server; nothing where they are here.
    stream::Part choose(const stream::GroupCost& group, std::optional<double> bytes_per_s) const;

    // Of the time that there is, so much may be needed: what is measured varies.
    static constexpr double kShare = 0.8;

  private:
    // A mean of seconds per unit, in which older values count less; 0 where nothing was added.
    class Mean {
      public:
        void add(double count, double seconds);
        double value() const { return count_ > 0 ? seconds_ / count_ : 0; }

      private:
        double count_ = 0, seconds_ = 0;
    };
    uint32_t frames_at_once_;
    Mean planes_;  // for each byte
    std::array<Mean, static_cast<size_t>(FrameStep::kCount)> steps_;
};

}  // namespace neuvv::render
