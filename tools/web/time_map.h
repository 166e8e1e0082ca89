// Time maps of stages as C functions, for browsers: engine/stage/time_map.h.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct NeuvvTimeMap NeuvvTimeMap;

// Of a clip, by the map's text, such as "loop:0:2s,speed:0.5". Null where there is no memory. To be freed by
// neuvv_time_map_free.
NeuvvTimeMap* neuvv_time_map_new(const char* text, uint32_t frames, double fps);
void neuvv_time_map_free(NeuvvTimeMap* map);
// Null, or what is wrong with the text in one line; the functions below may be called only of a map without an error.
const char* neuvv_time_map_error(const NeuvvTimeMap* map);

// At a time of the stage, seconds: the frame of the clip that is shown; where the clip is for who hears it, frames.
double neuvv_time_map_frame(const NeuvvTimeMap* map, double stage_s);
double neuvv_time_map_position(const NeuvvTimeMap* map, double stage_s);
// Seconds of stage time until it ends; infinite where it does not.
double neuvv_time_map_length(const NeuvvTimeMap* map);

#ifdef __cplusplus
}
#endif
