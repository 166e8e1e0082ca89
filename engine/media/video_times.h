// When the images of a video are shown.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace neuvv::media {

struct VideoTimes {
    std::vector<double> shown_s;       // of each frame, in order of display, by the file's own clock
    double fps = 0;                    // the rate at which it was recorded: frames that are lacking do not lower it
    std::optional<double> timecode_s;  // that of the first frame, as seconds of a day
};

// Packets are read where the file has no index, or where the index does not tell, as of frames at uneven times. Frames
// that an edit list cuts off are left out, as in VideoReader. Throws InputError.
VideoTimes video_times(const std::filesystem::path& path);

// The rate of frames at these ascending times, which are rounded to ticks of this length; 0 for fewer than two.
double rate_of(const std::vector<double>& times_s, double tick_s = 0);

}  // namespace neuvv::media
