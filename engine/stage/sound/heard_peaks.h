// How loud a performer's sound is over stage time, as the time map lets it be heard (heard.h): what a time line draws.
#pragma once

#include <span>
#include <vector>

#include "media/sound_peaks.h"
#include "stage/time_map.h"

namespace neuvv::stage {

// A part of a clip's time, in frames: 0 to the clip's end, which is the number of its frames.
struct ClipPart {
    double begin = 0, end = 0;
};

// The parts of the clip that are heard between two stage times, in the order of the clip and apart from each other.
// They are exactly where clip_position goes, but for the times at which it stands still, which are silent. `parts` is
// replaced.
void heard_parts(const Timeline& timeline, double from_s, double to_s, std::vector<ClipPart>& parts);

// The largest amplitude, 0 to 1, that is heard in each column of a time line: column i is from begin_s + i · column_s
// on, column_s seconds of stage time long. Peaks are as exact as their buckets.
void heard_peaks(const media::SoundPeaks& peaks, const Timeline& timeline, double begin_s, double column_s,
                 std::span<float> columns);

}  // namespace neuvv::stage
