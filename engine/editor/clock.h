// The clock of the stage: the stage time that is displayed while the stage plays, is stepped through, or is scrubbed.
//
// Times are seconds of the stage. The frames of the stage are at k / fps for whole numbers k, from 0 up to, not
// including, its duration. The range from `in_s` up to, not including, `out_s` is what plays in a loop.
#pragma once

#include <cstdint>

namespace neuvv::editor {

class StageClock {
  public:
    // The owner may change these at any time.
    bool playing = false;
    bool loops = true;
    double speed = 1;  // stage seconds per real second; negative: backwards

    // Takes the duration and the frame rate of another stage, or of this stage after an edit. A range that covered the
    // whole stage still does; another range is clipped to the new duration. The time is kept, or clipped. duration_s
    // may be 0: then nothing moves. fps > 0.
    void set_stage(double duration_s, double fps);

    double time_s() const { return time_s_; }
    // The stage time that is displayed. While the stage plays, this is time_s rounded down to a whole frame, because
    // clips have whole frames and slices are cached for those. At a speed below 1, frames are divided so that the
    // display still changes fps times per second. While the stage is paused, this is time_s itself.
    double displayed_s() const;
    // The n-th displayed time after that one, if the stage goes on playing.
    double displayed_after_s(int32_t n) const;
    double duration_s() const { return duration_s_; }
    double fps() const { return fps_; }
    double in_s() const { return in_s_; }
    double out_s() const { return out_s_; }
    // The frame that is displayed. Between two frames, the earlier one.
    int64_t frame() const;
    int64_t frames() const;                                                        // at least 1
    double last_s() const { return static_cast<double>(last_in_range()) / fps_; }  // the range's last frame

    // Sets the range, clipped to the stage and at least one frame long; the two ends may come in either order. The time
    // stays.
    void set_range(double in_s, double out_s);

    // Stops at the displayed time.
    void pause();
    // Real seconds until the displayed time changes; infinite while paused.
    double until_next_s() const;
    // Starts or stops playing. Where playing would end at once, it starts at the other end of the range.
    void play_or_pause();
    // Advances by so much real time. From outside the range the time moves into it. At an end of the range a loop goes
    // on at the other end with the remainder of the step, so that nothing drifts; without a loop the clock stops at the
    // last frame in its direction. A step that is negative or not finite does nothing.
    void tick(double real_s);
    // Stops, and moves by so many frames. Between two frames, 1 is the next frame and −1 the one before. From inside
    // the range, the result stays inside: it wraps around where the clock loops, and is clipped where it does not. From
    // outside, it is clipped to the stage.
    void step(int32_t by);
    // Moves to a time of the stage, inside or outside the range. A time that is not finite is ignored.
    void scrub(double time_s);

  private:
    int64_t first_in_range() const, last_in_range() const;
    double displayed_step_s() const;

    double duration_s_ = 0, fps_ = 25;
    double in_s_ = 0, out_s_ = 0;
    double time_s_ = 0;
};

}  // namespace neuvv::editor
