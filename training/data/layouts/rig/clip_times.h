// Which frames of several videos show the same moment: by their times, not by their numbers, since cameras may drop
// frames, record at different rates, or start at different times.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "media/video_times.h"
#include "training/data/layouts/rig/presentation.h"

namespace neuvv::training {

struct ClipVideo {
    std::string name;  // of its camera, for remarks
    std::filesystem::path path;
    media::VideoTimes times;
};

constexpr int64_t kNotInClip = -1;

struct ClipTimes {
    double fps = 0;
    std::vector<std::vector<int64_t>> frames;  // of each video, of each of its frames: its number in the clip
    TextsByCamera texts;                       // what is lacking, and what is left out
    std::vector<std::string> remarks;
};

// The clip has the rate that most videos have; of two that are equally frequent, the lower, at which every camera has
// an image of every moment. Its first frame is the earliest one of a video. A frame has the number of the moment that
// it is nearest to, within half a frame of the slower and of the faster rate. Where all videos have timecodes, these
// are their clocks, else the times in their files. Moments before the first and after the last that half of the videos
// have are left out. Throws InputError where there is no such moment.
ClipTimes clip_times(const std::vector<ClipVideo>& videos);

}  // namespace neuvv::training
