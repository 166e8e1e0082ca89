#include "training/run/run_clock.h"

#include <algorithm>
#include <limits>

namespace neuvv::training {

void RunClock::go_on(const RunState& run) {
    own_before_.elapsed_s += run.elapsed_s;
    own_before_.other_s += run.other_s;
    minutes_ = run.minutes;
    steps_ = run.steps;
}

bool RunClock::agree(bool go_on) {
    if (team_.is_alone()) return go_on;
    struct Word {
        Time time;
        bool go_on;
    };
    const std::vector<Word> words = gather_values(team_, Word{own(), go_on});
    of_team_ = words[0].time;
    return std::all_of(words.begin(), words.end(), [](const Word& word) { return word.go_on; });
}

// In a budget of minutes, it is the time of the steps so far in that time and what is left: were a checkpoint or a
// change of the tree progress, too, a phase could end before rays have seen its leaves, and leaves would be removed
// that are needed.
double RunClock::fraction(uint64_t step) const {
    double share = 0;
    if (steps_ > 0) share = static_cast<double>(step) / static_cast<double>(steps_);
    if (minutes_ > 0) {
        const double left = 60 * minutes_ - now().elapsed_s;
        share = std::max(share, left > 0 ? steps_s() / (steps_s() + left) : 1.0);
    }
    return std::min(share, 1.0);
}

double RunClock::seconds_left(uint64_t step) const {
    const double done = fraction(step);
    return done > 0 ? std::max(steps_s() / done - steps_s(), 0.0) : std::numeric_limits<double>::infinity();
}

}  // namespace neuvv::training
