// The pace of a stream as C functions, for browsers: how many parts of its frames come in time, as engine/render/clips/
// frame_pace.h chooses for the programs of this repository. One thread calls them.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct NeuvvFramePace NeuvvFramePace;

// To be freed by neuvv_frame_pace_free. Null where there is no memory.
NeuvvFramePace* neuvv_frame_pace_new(uint32_t frames_at_once);
void neuvv_frame_pace_free(NeuvvFramePace* pace);

// What a frame took, as stream::DecodeTimes has it, and then until it could be drawn.
void neuvv_frame_pace_learn(NeuvvFramePace* pace, uint32_t shapes, double shapes_s, double plane_bytes, double planes_s,
                            double upload_s);
// A frame was there so many seconds after it was asked for.
void neuvv_frame_pace_learn_arrival(NeuvvFramePace* pace, double seconds);

// How many parts of a group's frames, 2 to 5, come in time. `bytes_until`: of all frames of the group, up to each of
// the five parts. `bytes_per_s`: as they come from a server, 0 where nobody knows yet; below 0 where they are here.
uint32_t neuvv_frame_pace_parts(NeuvvFramePace* pace, uint32_t group, const double* bytes_until, uint32_t frames,
                                double seconds, double bytes_per_s, double now_s);
// A frame that is asked for now is nearly always there after so many seconds.
double neuvv_frame_pace_lead(const NeuvvFramePace* pace);

#ifdef __cplusplus
}
#endif
