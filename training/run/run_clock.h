// How long a run has taken, and how much of its budget is spent.
#pragma once

#include <cstdint>

#include "base/seconds.h"
#include "training/run/checkpoint.h"
#include "training/step/team.h"

namespace neuvv::training {

// Owns the run's time: the processes before this one took a part of it. In a team it is what the first member said
// before this step, so that all members decide alike.
class RunClock {
  public:
    // As in RunState.
    struct Time {
        double elapsed_s = 0, other_s = 0;
    };

    // Starts. `team` must outlive it.
    explicit RunClock(const Team& team) : team_(team), began_(seconds_now()) {}
    // Adds the time that the run took before, and takes over its budget.
    void go_on(const RunState& run);

    // Does what is no step of training: its time does not count as progress.
    template <typename Work>
    void aside(const Work& work) {
        const double start = seconds_now();
        work();
        own_before_.other_s += seconds_now() - start;
    }
    // All that this process did so far was no step.
    void count_beginning() { own_before_.other_s += seconds_now() - began_; }
    // Takes over the first member's clock. Returns whether all members want to go on.
    bool agree(bool go_on);

    // Of this process, for the checkpoint.
    Time own() const { return {own_before_.elapsed_s + seconds_now() - began_, own_before_.other_s}; }
    Time now() const { return team_.is_alone() ? own() : of_team_; }
    // The share of the steps that are done; `step` are.
    double fraction(uint64_t step) const;
    // Seconds until the budget is spent; changes of the tree and the like come on top of a budget in steps.
    double seconds_left(uint64_t step) const;

  private:
    double steps_s() const { return now().elapsed_s - now().other_s; }

    const Team& team_;
    double began_;
    Time own_before_;  // elapsed_s: until this process began
    Time of_team_;
    double minutes_ = 0;  // the budget, as in RunState
    uint64_t steps_ = 0;
};

}  // namespace neuvv::training
