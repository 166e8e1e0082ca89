// The clock of the stage: which time is shown while it plays, is stepped through, or is scrubbed.
//
// Times are seconds of the stage. The stage's frames are at k / fps for whole k, from 0 to before its duration. A range
// from `in` up to, not including, `out` is what plays in a loop.
#pragma once

#include <cstdint>

namespace neuvv::editor {

class StageClock {
  public:
    // Anyone may change these at any time.
    bool playing = false;
    bool loops = true;
    double speed = 1;  // stage seconds a second; negative: backwards

    // Of another stage, or of this one after an edit: a range that was the whole stays the whole, another is cut to
    // what there is, and the time is kept if it can be. A duration may be 0: then nothing moves. fps > 0.
    void set_stage(double duration_s, double fps);

    double time_s() const { return time_s_; }
    // The time that is shown. While the stage plays, time_s is rounded down to a whole frame, because clips have whole
    // frames and slices are cached for those; played slower than real time, frames are divided so that as many are
    // shown each second. While it stands, the same as time_s.
    double displayed_s() const;
    // The n-th time that will be shown after that one, if the stage goes on playing.
    double displayed_after_s(int32_t n) const;
    double duration_s() const { return duration_s_; }
    double fps() const { return fps_; }
    double in_s() const { return in_s_; }
    double out_s() const { return out_s_; }
    // The frame that is shown; the one before where the time lies between two.
    int64_t frame() const;
    int64_t frames() const;                                                        // at least 1
    double last_s() const { return static_cast<double>(last_in_range()) / fps_; }  // the range's last image

    // The range, cut to the stage, at least one image long; ends in the wrong order are exchanged. The time stays.
    void set_range(double in_s, double out_s);

    // Stops at the time that is shown.
    void pause();
    // Real seconds until another time is shown; infinite where none will be.
    double until_next_s() const;
    // Plays, or stops. From where it would stop at once it begins anew, at the range's other end.
    void play_or_pause();
    // So much real time has passed. From outside of the range it plays into it; at the range's end it goes on at its
    // other end, with what was left of the step, so that nothing drifts; or, where it does not loop, stops at the last
    // image of that side. Steps that are negative or not finite are none.
    void tick(double real_s);
    // Stops, and goes to the n-th image from here: from between two, 1 is the next and −1 the one before. Inside of
    // the range it stays there, by loops or by its ends; outside, the stage's own ends hold.
    void step(int32_t by);
    // Goes to a time of the stage, in the range or not. Not finite: stays.
    void scrub(double time_s);

  private:
    int64_t first_in_range() const, last_in_range() const;
    double displayed_step_s() const;

    double duration_s_ = 0, fps_ = 25;
    double in_s_ = 0, out_s_ = 0;
    double time_s_ = 0;
};

}  // namespace neuvv::editor
