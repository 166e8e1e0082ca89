// The pace at which the frames of a stream come to the device while it plays, and what follows from it for the next
// ones: how many of their parts are taken, and which of them are still worth beginning with.
#pragma once

#include <mutex>
#include <vector>

#include "render/clips/ladder.h"

namespace neuvv::render {

// Any thread may call its functions.
class FramePace {
  public:
    explicit FramePace(uint32_t frames_at_once) : ladder_(frames_at_once) {}
    // What a frame took that was decoded and uploaded.
    void learn(const stream::DecodeTimes& decoded, double upload_s);
    // A frame was there so many seconds after it was asked for.
    void learn_arrival(double seconds);

    // The last part of a frame that comes in time while the stream plays at its own speed. It is the same for all
    // frames of a group for so many seconds and twice the group's length; then it is chosen anew. `now_s`: of a clock
    // that never goes back.
    static constexpr double kLeastChoice_s = 1;
    stream::Part part_in_time(const stream::GroupCost& group, std::optional<double> bytes_per_s, double now_s);

    // A frame that is asked for now is there after so many seconds or sooner, nearly always: the mean and two mean
    // deviations, at most kMostLead_s; 0 where none came yet.
    static constexpr double kMostLead_s = 1;
    double lead_s() const;

  private:
    mutable std::mutex mutex_;  // guards what follows
    Ladder ladder_;
    struct Chosen {
        uint32_t group = 0;
        stream::Part last = stream::kShFine;
        double until_s = 0;
    };
    std::vector<Chosen> chosen_;              // by part_in_time()
    double arrival_s_ = 0, deviation_s_ = 0;  // means in which older values count less; 0: there was none
};

}  // namespace neuvv::render
